#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "commands.hpp"
#include "image/board_costs.hpp"
#include "image/model_signature.hpp"
#include "run/model_size.hpp"
#include "scan/preview.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/builder/openings.hpp"
#include "tactree/core/model/interior.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {
namespace {

using core::BlobHeader;
using core::BlobView;

struct InfoOptions {
  std::string blob;
  std::string device;
  std::string board;
  std::string json;
  std::string points;
  std::string preview;
};

const char* profile_name(const BlobHeader& header) {
  return header.profile == static_cast<std::uint32_t>(core::Profile::kPaper) ? "paper" : "surface";
}

double to_double(core::BlobDouble words) {
  return std::bit_cast<double>(std::uint64_t{words.high} << 32 | words.low);
}

// Converts to the double of the shortest decimal representation: 0.0005, not 0.00050000002.
double shortest(float v) { return std::strtod(fmt::format("{}", v).c_str(), nullptr); }

std::string length(float metres) { return builder::length_text(shortest(metres), 6); }

double bytes_per_point(const BlobHeader& header) {
  return static_cast<double>(header.total_bytes) / header.point_count;
}

std::string digest(const BlobHeader& header) {
  std::string text;
  for (const std::uint8_t byte : header.source_digest) {
    fmt::format_to(std::back_inserter(text), "{:02x}", byte);
  }
  return text;
}

/// Number of points per material.
std::vector<std::uint32_t> points_of_materials(const BlobView& view) {
  std::vector<std::uint32_t> counts(view.material_count(), 0);
  for (std::uint32_t i = 0; i < view.point_count() && !counts.empty(); ++i) {
    ++counts[view.material_of(i)];
  }
  return counts;
}

nlohmann::json materials_json(const BlobView& view) {
  nlohmann::json list = nlohmann::json::array();
  const std::vector<std::uint32_t> points = points_of_materials(view);
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    const core::BlobMaterial& m = view.material(i);
    list.push_back({{"points", points[i]},
                    {"stiffness_N_m", shortest(m.stiffness_N_m)},
                    {"damping_Ns_m", shortest(m.damping_Ns_m)},
                    {"static_friction", shortest(m.static_friction)},
                    {"dynamic_friction", shortest(m.dynamic_friction)},
                    {"texture_height_m", shortest(m.texture_height_m)},
                    {"texture_wavelength_m", shortest(m.texture_wavelength_m)}});
  }
  return list;
}

std::uint32_t interior_bytes(const BlobView& view) {
  return view.interior() == nullptr ? 0U : view.node_count() + view.leaf_count();
}

/// Fraction of the points with material behind them.
double backed_share(const BlobView& view) {
  std::uint32_t backed = 0;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    const core::Vec3 inside_leaf = view.position(leaf, leaf.first_point);
    backed += core::interior_at(view, inside_leaf).behind ? leaf.point_count : 0U;
  }
  return static_cast<double>(backed) / view.point_count();
}

nlohmann::json to_json(const BlobView& view) {
  const BlobHeader& h = view.header();
  const auto triple = [](const float* v) {
    return nlohmann::json::array({shortest(v[0]), shortest(v[1]), shortest(v[2])});
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
      {"spacing_m", shortest(h.spacing_m)},
      {"support_radius_m", shortest(h.support_radius_m)},
      {"reach_m", shortest(h.reach_m)},
      {"leaf_edge_min_m", shortest(h.leaf_edge_min_m)},
      {"aabb_edge_m", shortest(h.aabb_edge_m)},
      {"six_point_offset_m", shortest(h.six_point_offset_m)},
      {"largest_gap_m", shortest(h.largest_gap_m)},
      {"quantisation_step_m", 2.0 * shortest(h.step_m)},
      {"points_per_leaf_max", h.points_per_leaf_max},
      {"points_per_ball_max", h.points_per_ball_max},
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

void print_sizes(const BlobView& view) {
  const BlobHeader& h = view.header();
  fmt::print("memory        {} bytes, {:.3f} bytes per point\n", h.total_bytes, bytes_per_point(h));
  const auto row = [&](const char* name, std::uint32_t bytes) {
    if (bytes != 0) {
      fmt::print("  {:<12}{:>10}  {:>5.1f} %  {:.3f} per point\n", name, bytes,
                 100.0 * bytes / h.total_bytes, static_cast<double>(bytes) / h.point_count);
    }
  };
  row("header", h.header_bytes - interior_bytes(view));
  row("octree", h.nodes.bytes);
  row("directory", h.directory.bytes);
  row("leaves", h.leaf_bases.bytes + h.leaf_offsets.bytes);
  row("positions", h.points.bytes);
  row("normals", h.normals.bytes);
  row("neighbours", h.neighbours.bytes);
  row("materials", h.materials.bytes + h.material_indices.bytes);
  row("interior", interior_bytes(view));
}

void print_materials(const BlobView& view) {
  const std::vector<std::uint32_t> points = points_of_materials(view);
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    const core::BlobMaterial& m = view.material(i);
    fmt::print("material {:<4} {} points: {:.6g} N/m, {:.6g} Ns/m, friction {:.6g} / {:.6g}", i,
               points[i], m.stiffness_N_m, m.damping_Ns_m, m.static_friction, m.dynamic_friction);
    if (m.texture_height_m > 0.0F) {
      fmt::print(", texture {} every {}", length(m.texture_height_m),
                 length(m.texture_wavelength_m));
    }
    fmt::print("\n");
  }
}

void print_bounds(const BlobHeader& h) {
  const Eigen::Vector3f low(h.bounds_min_m);
  const Eigen::Vector3f high(h.bounds_max_m);
  fmt::print("size          {}\n", builder::size_text((high - low).cast<double>()));
  const float farthest = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  const builder::LengthUnit unit = builder::length_unit(static_cast<double>(farthest));
  fmt::print("bounds      ");
  for (int axis = 0; axis < 3; ++axis) {
    fmt::print("  {} {} ... {}", "xyz"[axis],
               builder::number_text(unit.per_metre * shortest(low[axis]), 6),
               builder::number_text(unit.per_metre * shortest(high[axis]), 6));
  }
  fmt::print(" {}\n", unit.name);
}

void print(const BlobView& view) {
  const BlobHeader& h = view.header();
  fmt::print("model         {} ({} profile, format {}.{}, {})\n", h.name, profile_name(h),
             h.version_major, h.version_minor, h.tool_version);
  fmt::print("points        {} in {} leaves, {} nodes, depth {}\n", h.point_count, h.leaf_count,
             h.node_count, h.depth);
  print_bounds(h);
  fmt::print("spacing       {}; positions rounded to {}\n", length(h.spacing_m),
             builder::length_text(2.0 * shortest(h.step_m), 3));
  fmt::print("largest gap   {}\n", length(h.largest_gap_m));
  fmt::print("support       {}; exact queries up to {}; leaf edge {}\n", length(h.support_radius_m),
             length(h.reach_m), length(h.leaf_edge_min_m));
  fmt::print(
      "limits        {} points per leaf, {} in a ball of {}, {} leaves and {} points per query\n",
      h.points_per_leaf_max, h.points_per_ball_max, length(h.reach_m), h.leaves_per_query_max,
      h.points_per_query_max);
  if (view.interior() != nullptr) {
    fmt::print("interior      material behind {:.0f} % of the points\n",
               100.0 * backed_share(view));
  }
  print_materials(view);
  print_sizes(view);
}

// Nine digits preserve a float32 exactly.
void write_points(const BlobView& view, const std::string& file) {
  std::string text = "index,x,y,z,nx,ny,nz\n";
  std::size_t index = 0;
  for (const core::SurfacePoint& p : support::decode_points(view)) {
    fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n",
                   index++, p.position.x, p.position.y, p.position.z, p.normal.x, p.normal.y,
                   p.normal.z);
  }
  support::write_file(file, text);
}

void print_costs(const core::BlobHeader& header, const std::string& name,
                 const std::string& device) {
  const BoardCosts board = costs_of_board(name);
  fmt::print(
      "\non {} ({}): {}{}\n", name, board.image,
      board.embedded ? "costs stored in the image" : "analysed now, because the image has no costs",
      board.timing.is_estimate ? "; an estimate" : "");
  core::Configuration configuration;
  configuration.device = slowest_or(device);
  for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
    configuration.mode = mode;
    const double highest = std::floor(board.highest_rate(header, configuration));
    configuration.rate_hz = static_cast<float>(highest);
    core::TickLoad load;
    load.add(header, configuration);
    const core::TickCost& cost = core::worst_row(board.costs, load);
    fmt::print("{:<8}  up to {:.0f} Hz: at most {:.0f} cycles per tick at {:.0f} MHz\n",
               mode == core::RenderMode::kPaper ? "paper" : "surface", highest,
               board.cycles(header, configuration), 1e-6 * board.timing.clock_hz);
    fmt::print("          = {}",
               board.costs.base + (load.delta ? board.costs.delta : 0) + cost.base);
    for (std::uint32_t i = 0; i < core::kModelLimits; ++i) {
      if (cost.per_limit[i] != 0) {
        fmt::print(" + {} {}", cost.per_limit[i], core::kModelLimitNames[i]);
      }
    }
    fmt::print("\n");
  }
}

/// null if there is no signature.
nlohmann::json signature_json(const std::string& file, const support::BlobFile& blob) {
  const std::optional<ModelSignature> signature = read_signature(file);
  if (!signature) {
    return nullptr;
  }
  return {{"board", signature->board},
          {"counter", signature->counter},
          {"key", to_hex(signature->key)},
          {"valid", is_valid(*signature, blob.bytes())}};
}

void print_signature(const std::string& file, const support::BlobFile& blob) {
  if (const std::optional<ModelSignature> signature = read_signature(file)) {
    fmt::print("signature     {}: {}\n", is_valid(*signature, blob.bytes()) ? "valid" : "NOT VALID",
               describe(*signature));
  }
}

/// Warning for the given device if it does not reach the model, else that for any device.
std::optional<std::string> size_warning_of(const InfoOptions& options, const BlobHeader& model) {
  std::optional<std::string> warning;
  if (!options.device.empty()) {
    warning = oversize_warning(options.blob, model, options.device,
                               support::load_device(options.device).preset.model);
  }
  return warning ? warning : size_warning(options.blob, model);
}

void info(const InfoOptions& options) {
  support::check_outputs({options.json, options.points, options.preview}, {options.blob});
  const support::BlobFile blob = support::BlobFile::named(options.blob);
  print(blob.view());
  print_signature(options.blob, blob);
  if (!options.board.empty()) {
    print_costs(blob.view().header(), options.board, options.device);
  }
  const std::optional<std::string> warning = size_warning_of(options, blob.view().header());
  if (warning) {
    fmt::print(stderr, "tactree: warning: {}\n", *warning);
  }
  if (!options.json.empty()) {
    nlohmann::json json = to_json(blob.view());
    json["warnings"] = nlohmann::json::array();
    if (warning) {
      json["warnings"].push_back(*warning);
    }
    json["signature"] = signature_json(options.blob, blob);
    support::write_file(options.json, support::json_text(json));
  }
  if (!options.points.empty()) {
    write_points(blob.view(), options.points);
  }
  if (!options.preview.empty()) {
    write_preview(options.preview, blob.view(), builder::find_openings(blob.view()));
  }
}

}  // namespace

void add_info_command(CLI::App& app, int&) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = app.add_subcommand(
      "info", "Prints the contents of a blob, its limits and the size of its sections");
  verb->add_option("BLOB", options->blob, "blob to inspect; -: standard input")->required();
  verb->add_option("--board", options->board,
                   "also print the cost of a tick with this model on the board")
      ->check(CLI::IsMember(boards_with_timing()));
  verb->add_option("--device", options->device,
                   "name or file of a device: also report whether it reaches the model; used by "
                   "--board, too (default: the kind with the longest tick)");
  verb->add_option("--json", options->json, "write the values as JSON to this file");
  verb->add_option("--points", options->points,
                   "write all points to this CSV file: index,x,y,z,nx,ny,nz (m)");
  verb->add_option(
      "--preview", options->preview,
      "write a picture of the model to this PNG file, with a scale and marked openings");
  verb->callback([options] { info(*options); });
}

}  // namespace tactree::cli
