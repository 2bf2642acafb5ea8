#include "tactree/support/blob_facts.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <iterator>
#include <string>

#include "tactree/core/model/interior.hpp"

namespace tactree::support {
namespace {

using core::BlobHeader;
using core::BlobView;

double to_double(core::BlobDouble words) {
  return std::bit_cast<double>(std::uint64_t{words.high} << 32 | words.low);
}

std::string digest(const BlobHeader& header) {
  std::string text;
  for (const std::uint8_t byte : header.source_digest) {
    fmt::format_to(std::back_inserter(text), "{:02x}", byte);
  }
  return text;
}

nlohmann::json materials_json(const BlobView& view) {
  nlohmann::json list = nlohmann::json::array();
  const std::vector<std::uint32_t> points = points_of_materials(view);
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    const core::BlobMaterial& m = view.material(i);
    list.push_back({{"points", points[i]},
                    {"stiffness_N_m", shortest_double(m.stiffness_N_m)},
                    {"damping_Ns_m", shortest_double(m.damping_Ns_m)},
                    {"static_friction", shortest_double(m.static_friction)},
                    {"dynamic_friction", shortest_double(m.dynamic_friction)},
                    {"texture_height_m", shortest_double(m.texture_height_m)},
                    {"texture_wavelength_m", shortest_double(m.texture_wavelength_m)}});
  }
  return list;
}

}  // namespace

const char* profile_name(const BlobHeader& header) {
  return header.profile == static_cast<std::uint32_t>(core::Profile::kPaper) ? "paper" : "surface";
}

double shortest_double(float v) { return std::strtod(fmt::format("{}", v).c_str(), nullptr); }

double bytes_per_point(const BlobHeader& header) {
  return static_cast<double>(header.total_bytes) / header.point_count;
}

std::vector<std::uint32_t> points_of_materials(const BlobView& view) {
  std::vector<std::uint32_t> counts(view.material_count(), 0);
  for (std::uint32_t i = 0; i < view.point_count() && !counts.empty(); ++i) {
    ++counts[view.material_of(i)];
  }
  return counts;
}

std::uint32_t interior_bytes(const BlobView& view) {
  return view.interior() == nullptr ? 0U : view.node_count() + view.leaf_count();
}

double backed_share(const BlobView& view) {
  std::uint32_t backed = 0;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    const core::Vec3 inside_leaf = view.position(leaf, leaf.first_point);
    backed += core::interior_at(view, inside_leaf).behind ? leaf.point_count : 0U;
  }
  return static_cast<double>(backed) / view.point_count();
}

nlohmann::json blob_facts(const BlobView& view) {
  const BlobHeader& h = view.header();
  const auto triple = [](const float* v) {
    return nlohmann::json::array(
        {shortest_double(v[0]), shortest_double(v[1]), shortest_double(v[2])});
  };
  return {
      {"name", h.name},
      {"profile", profile_name(h)},
      {"points", h.point_count},
      {"leaves", h.leaf_count},
      {"nodes", h.node_count},
      {"materials", h.material_count},
      {"material_list", materials_json(view)},
      {"depth", h.depth},
      {"bytes", h.total_bytes},
      {"bytes_per_point", bytes_per_point(h)},
      {"section_bytes",
       {{"header", h.header_bytes - interior_bytes(view)},
        {"nodes", h.nodes.bytes},
        {"directory", h.directory.bytes},
        {"leaves", h.leaf_bases.bytes + h.leaf_offsets.bytes},
        {"points", h.points.bytes},
        {"normals", h.normals.bytes},
        {"neighbours", h.neighbours.bytes},
        {"materials", h.materials.bytes + h.material_indices.bytes},
        {"interior", interior_bytes(view)}}},
      {"backed_share", backed_share(view)},
      {"spacing_m", shortest_double(h.spacing_m)},
      {"support_radius_m", shortest_double(h.support_radius_m)},
      {"reach_m", shortest_double(h.reach_m)},
      {"leaf_edge_min_m", shortest_double(h.leaf_edge_min_m)},
      {"aabb_edge_m", shortest_double(h.aabb_edge_m)},
      {"six_point_offset_m", shortest_double(h.six_point_offset_m)},
      {"largest_gap_m", shortest_double(h.largest_gap_m)},
      {"quantisation_step_m", 2.0 * shortest_double(h.step_m)},
      {"points_per_leaf_max", h.points_per_leaf_max},
      {"points_per_ball_max", h.points_per_ball_max},
      {"points_per_support_max", core::points_per_support_max(h)},
      {"points_per_query_max", h.points_per_query_max},
      {"leaves_per_query_max", h.leaves_per_query_max},
      {"bounds_min_m", triple(h.bounds_min_m)},
      {"bounds_max_m", triple(h.bounds_max_m)},
      {"source_scale", to_double(h.source_scale)},
      {"source_origin",
       {to_double(h.source_origin[0]), to_double(h.source_origin[1]),
        to_double(h.source_origin[2])}},
      {"source_sha256", digest(h)},
      {"checksum", fmt::format("{:08x}", h.checksum)},
      {"format", fmt::format("{}.{}", h.version_major, h.version_minor)},
      {"tool", h.tool_version},
  };
}

}  // namespace tactree::support
