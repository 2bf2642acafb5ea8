#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "image/board_costs.hpp"
#include "image/model_signature.hpp"
#include "option_checks.hpp"
#include "scan/named_materials.hpp"
#include "scan/preview.hpp"
#include "tactree/builder/length_text.hpp"
#include "tactree/builder/materials.hpp"
#include "tactree/builder/openings.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/support/blob_facts.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/colour_file.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

using core::BlobHeader;
using core::BlobView;

struct InfoOptions {
  std::string blob;
  std::string device;
  std::string board;
  std::string material;
  std::string json;
  std::string points;
  std::string preview;
  std::string colours;
};

std::string length(float metres) {
  return builder::length_text(support::shortest_double(metres), 6);
}

void print_sizes(const BlobView& view) {
  const BlobHeader& h = view.header();
  fmt::print("memory        {} bytes, {:.3f} bytes per point\n", h.total_bytes,
             support::bytes_per_point(h));
  const auto row = [&](const char* name, std::uint32_t bytes) {
    if (bytes != 0) {
      fmt::print("  {:<12}{:>10}  {:>5.1f} %  {:.3f} per point\n", name, bytes,
                 100.0 * bytes / h.total_bytes, static_cast<double>(bytes) / h.point_count);
    }
  };
  row("header", h.header_bytes - support::interior_bytes(view));
  row("octree", h.nodes.bytes);
  row("directory", h.directory.bytes);
  row("leaves", h.leaf_bases.bytes + h.leaf_offsets.bytes);
  row("positions", h.points.bytes);
  row("normals", h.normals.bytes);
  row("neighbours", h.neighbours.bytes);
  row("materials", h.materials.bytes + h.material_indices.bytes);
  row("interior", support::interior_bytes(view));
}

/// A blob has no names. `named`: the materials of the build, if the user gives them.
void print_materials(const BlobView& view, const std::optional<builder::MaterialMap>& named) {
  const std::vector<std::uint32_t> points = support::points_of_materials(view);
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    const core::BlobMaterial& m = view.material(i);
    const std::string name = named ? builder::describe_material(*named, i) + ": " : "";
    fmt::print("material {:<4} {}{} points: {:.6g} N/m, {:.6g} Ns/m, friction {:.6g} / {:.6g}", i,
               name, points[i], m.stiffness_N_m, m.damping_Ns_m, m.static_friction,
               m.dynamic_friction);
    if (m.texture_height_m > 0.0F) {
      fmt::print(", texture {} every {}", length(m.texture_height_m),
                 length(m.texture_wavelength_m));
    }
    fmt::print("\n");
  }
  if (view.material_count() > 1 && !named) {
    fmt::print("              (--material FILE, the file of the build, names them)\n");
  }
}

/// Adds names and colours to the list of materials.
void add_names(const builder::MaterialMap& map, nlohmann::json& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    list[i]["name"] = builder::material_name(map, i);
    if (i > 0) {
      list[i]["rgb"] = map.colours[i - 1].colour;
      list[i]["tolerance"] = map.colours[i - 1].tolerance;
    }
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
               builder::number_text(unit.per_metre * support::shortest_double(low[axis]), 6),
               builder::number_text(unit.per_metre * support::shortest_double(high[axis]), 6));
  }
  fmt::print(" {}\n", unit.name);
}

void print(const BlobView& view, const std::optional<builder::MaterialMap>& named) {
  const BlobHeader& h = view.header();
  fmt::print("model         {} ({} profile, format {}.{}, {})\n", h.name, support::profile_name(h),
             h.version_major, h.version_minor, h.tool_version);
  fmt::print("points        {} in {} leaves, {} nodes, depth {}\n", h.point_count, h.leaf_count,
             h.node_count, h.depth);
  print_bounds(h);
  fmt::print("spacing       {}; positions rounded to {}\n", length(h.spacing_m),
             builder::length_text(2.0 * support::shortest_double(h.step_m), 3));
  fmt::print("largest gap   {}\n", length(h.largest_gap_m));
  fmt::print("support       {}; exact queries up to {}; leaf edge {}\n", length(h.support_radius_m),
             length(h.reach_m), length(h.leaf_edge_min_m));
  fmt::print(
      "limits        {} points per leaf, {} in a ball of {}, {} in the support of a fit, {} leaves "
      "and {} points per query\n",
      h.points_per_leaf_max, h.points_per_ball_max, length(h.reach_m),
      core::points_per_support_max(h), h.leaves_per_query_max, h.points_per_query_max);
  if (view.interior() != nullptr) {
    fmt::print("interior      material behind {:.0f} % of the points\n",
               100.0 * support::backed_share(view));
  }
  print_materials(view, named);
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

/// The cycles as a sum; without the limits that count as kLeastLimits.
void print_sum(const core::TickCosts& costs, const core::TickLoad& load) {
  using Limits = std::array<std::uint32_t, core::kModelLimits>;
  const auto limits = std::bit_cast<Limits>(load.limits);
  const auto least = std::bit_cast<Limits>(core::kLeastLimits);
  const core::TickCost& cost = core::worst_row(costs, load);
  fmt::print("          = {}",
             costs.base + (load.delta ? costs.delta : 0U) + costs.listed + cost.base);
  for (std::uint32_t i = 0; i < core::kModelLimits; ++i) {
    if (cost.per_limit[i] != 0 && limits[i] > least[i]) {
      fmt::print(" + {} * ({} - {})", cost.per_limit[i], core::kModelLimitNames[i], least[i]);
    }
  }
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
    load.work_tier = board.work_tier(header, configuration);
    fmt::print("{:<8}  up to {:.0f} Hz: at most {:.0f} cycles per tick at {:.0f} MHz\n",
               mode == core::RenderMode::kPaper ? "paper" : "surface", highest,
               board.cycles(header, configuration), 1e-6 * board.timing.clock_hz);
    print_sum(board.costs, load);
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
std::optional<std::string> size_warning_of(const InfoOptions& options, const BlobView& model) {
  if (!options.device.empty()) {
    const core::DeviceModel device = support::load_device(options.device).preset.model;
    if (const auto warning = setup::oversize_warning(model, options.device, device)) {
      return options.blob + ": " + *warning;
    }
  }
  return setup::size_warning(options.blob, model.header());
}

void info(const InfoOptions& options) {
  support::check_outputs(
      {options.json, options.points, options.preview},
      {options.blob, options.material, options.colours, options.device, options.board});
  const support::BlobFile blob = support::BlobFile::named(options.blob);
  const std::optional<builder::MaterialMap> named =
      named_materials(options.material, options.blob, blob.view());
  print(blob.view(), named);
  print_signature(options.blob, blob);
  if (!options.board.empty()) {
    print_costs(blob.view().header(), options.board, options.device);
  }
  const std::optional<std::string> warning = size_warning_of(options, blob.view());
  if (warning) {
    fmt::print(stderr, "tactree: warning: {}\n", *warning);
  }
  if (!options.json.empty()) {
    nlohmann::json json = support::blob_facts(blob.view());
    if (named) {
      add_names(*named, json["material_list"]);
    }
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
    std::vector<support::PointColour> colours;
    if (!options.colours.empty()) {
      colours = support::read_colours(options.colours, blob, options.blob);
    }
    write_preview(options.preview, blob.view(), builder::find_openings(blob.view()), {}, named,
                  colours);
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
      ->check(one_of(boards_with_timing()));
  verb->add_option("--device", options->device,
                   "name or file of a device: also report whether it reaches the model; --board "
                   "uses it, too (default: the kind with the longest tick)");
  verb->add_option("--material", options->material,
                   "the file that the build used for --material, which names the materials and "
                   "their colours");
  verb->add_option("--json", options->json, "write the values as JSON to this file");
  verb->add_option("--points", options->points,
                   "write all points to this CSV file: index,x,y,z,nx,ny,nz (m)");
  CLI::Option* preview =
      verb->add_option(
              "--preview", options->preview,
              "write a picture of the model to this PNG file, with a scale and marked openings")
          ->check(written_as(".png"));
  verb->add_option("--colours,--colors", options->colours,
                   "the file of build --colours: --preview draws the colours of the scan")
      ->needs(preview);
  verb->callback([options] { info(*options); });
}

}  // namespace tactree::cli
