#include "build_command.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "board_costs.hpp"
#include "command.hpp"
#include "json_text.hpp"
#include "material_file.hpp"
#include "output_file.hpp"
#include "preview.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/emulation/board_description.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;
using builder::BuildOptions;
using builder::BuildReport;
using builder::Opening;
using nlohmann::ordered_json;

const std::map<std::string, double> kUnits = {{"m", 1.0},   {"cm", 1e-2},   {"mm", 1e-3},
                                              {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
const std::map<std::string, builder::UpAxis> kAxes = {
    {"x", builder::UpAxis::kX}, {"y", builder::UpAxis::kY}, {"z", builder::UpAxis::kZ}};
const std::map<std::string, core::Profile> kProfiles = {{"surface", core::Profile::kSurface},
                                                        {"paper", core::Profile::kPaper}};
const std::map<std::string, builder::ProgressStyle> kProgressStyles = {
    {"auto", builder::ProgressStyle::kAuto},
    {"plain", builder::ProgressStyle::kPlain},
    {"json", builder::ProgressStyle::kJson},
    {"off", builder::ProgressStyle::kOff}};

constexpr std::size_t kOpeningsPrinted = 3;
constexpr std::size_t kOpeningsReported = 1000;

struct BuildArguments {
  std::vector<std::string> inputs;
  std::string output;
  std::string report;
  std::string preview;
  std::string json;
  std::vector<double> crop;
  std::string spacing;
  std::string budget;
  std::string board;
  std::string device;
  double rate_hz = 0.0;
  std::string material;
  bool no_resample = false;
  builder::ProgressStyle progress = builder::ProgressStyle::kAuto;
  BuildOptions build;
};

/// What fits the board's flash, where nothing else says how fine the model is to be.
void choose_for_board(BuildArguments& arguments) {
  const emulation::BoardDescription* const board = emulation::find_board(arguments.board);
  BuildOptions& build = arguments.build;
  if (board != nullptr && build.resample && !build.spacing_m && !build.flash_budget_bytes) {
    build.flash_budget_bytes = board->blob_bytes_max;
  }
}

[[noreturn]] void misuse(const std::string& option, const std::string& what) {
  throw CLI::ValidationError(option, what);
}

// A positive finite number, nothing after it.
double to_number(const std::string& option, const std::string& text) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || !std::isfinite(value)) {
    misuse(option, "'" + text + "' is not a number");
  }
  return value;
}

// 917504, 896K or 1M: bytes, or times 1024 or 1024 squared.
std::uint64_t to_bytes(const std::string& text) {
  double factor = 1.0;
  std::string number = text;
  const std::string suffixes = "KMG";
  const std::size_t suffix = number.empty() ? std::string::npos : suffixes.find(number.back());
  if (suffix != std::string::npos) {
    factor = std::ldexp(1.0, 10 * static_cast<int>(suffix + 1));
    number.pop_back();
  }
  const double bytes = factor * to_number("--flash-budget", number);
  if (!(bytes >= 1.0) || !(bytes < 4294967296.0)) {
    misuse("--flash-budget", "'" + text + "' is not between 1 byte and 4 GiB");
  }
  return static_cast<std::uint64_t>(bytes);
}

void require_positive(const std::string& option, const std::optional<double>& value) {
  if (value && !(*value > 0.0 && std::isfinite(*value))) {
    misuse(option, "must be positive");
  }
}

void complete(BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  require_positive("--scale", build.scale);
  require_positive("--fit", build.fit_m);
  if (!arguments.crop.empty()) {
    const auto& c = arguments.crop;
    if (!(c[0] < c[3] && c[1] < c[4] && c[2] < c[5])) {
      misuse("--crop", "wants xmin,ymin,zmin,xmax,ymax,zmax with min < max");
    }
    build.crop =
        Eigen::AlignedBox3d(Eigen::Vector3d(c[0], c[1], c[2]), Eigen::Vector3d(c[3], c[4], c[5]));
  }
  build.resample = !arguments.no_resample;
  if (!arguments.spacing.empty()) {
    const double spacing = to_number("--spacing", arguments.spacing);
    if (spacing < 0.0) {
      misuse("--spacing", "must not be negative");
    }
    if (spacing > 0.0) {
      build.spacing_m = spacing;
    } else {
      build.resample = false;
    }
  }
  if (!arguments.budget.empty()) {
    build.flash_budget_bytes = to_bytes(arguments.budget);
    if (!build.resample || build.spacing_m) {
      misuse("--flash-budget", "chooses the spacing; it excludes --spacing and --no-resample");
    }
  }
  choose_for_board(arguments);
  if (!arguments.material.empty()) {
    build.materials = read_materials(arguments.material);
  }
}

// Two names of one file, also through links.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  return fs::equivalent(a, b, unknown) ||
         fs::weakly_canonical(a, unknown) == fs::weakly_canonical(b, unknown);
}

void refuse_overwriting_inputs(const BuildArguments& arguments) {
  for (const std::string* output :
       {&arguments.output, &arguments.report, &arguments.json, &arguments.preview}) {
    for (const std::string& input : arguments.inputs) {
      if (!output->empty() && same_file(*output, input)) {
        throw CommandError(*output +
                           ": is an input and would be overwritten (choose another name)");
      }
    }
  }
}

ordered_json triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json openings_json(const BuildReport& report) {
  ordered_json list = ordered_json::array();
  for (const Opening& opening : report.openings) {
    if (list.size() == kOpeningsReported) {
      break;
    }
    list.push_back({{"kind", opening.kind == Opening::Kind::kHole ? "hole" : "rim"},
                    {"diameter_m", opening.diameter_m},
                    {"centre_m", triple(opening.centre)},
                    {"points", opening.points}});
  }
  return list;
}

double bytes_per_point(const BuildReport& report) {
  return static_cast<double>(report.bytes) / static_cast<double>(report.output_points);
}

std::string material_name(const BuildOptions& build, std::size_t index) {
  return index == 0 ? "default" : build.materials->colours[index - 1].name;
}

ordered_json materials_json(const BuildReport& report, const BuildOptions& build) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < report.material_points.size(); ++i) {
    list.push_back({{"name", material_name(build, i)}, {"points", report.material_points[i]}});
  }
  return list;
}

ordered_json to_json(const BuildReport& report, const BuildOptions& build) {
  ordered_json inputs = ordered_json::array();
  for (const builder::InputReport& input : report.inputs) {
    inputs.push_back({{"file", input.file},
                      {"format", input.format},
                      {"points", input.points},
                      {"triangles", input.triangles}});
  }
  ordered_json dropped = ordered_json::object();
  for (const auto& [cause, count] : report.dropped) {
    dropped[cause] = count;
  }
  return {{"inputs", inputs},
          {"input_points", report.input_points},
          {"kept_points", report.kept_points},
          {"dropped", dropped},
          {"sampled_points", report.sampled_points},
          {"thinned_points", report.thinned},
          {"merged_points", report.merged},
          {"output_points", report.output_points},
          {"spacing_m", report.spacing_m},
          {"largest_gap_m", report.largest_gap_m},
          {"openings", openings_json(report)},
          {"pieces", report.pieces},
          {"materials", materials_json(report, build)},
          {"bounds_min_m", triple(report.bounds.min())},
          {"bounds_max_m", triple(report.bounds.max())},
          {"source_scale", report.source_scale},
          {"source_origin", triple(report.source_origin)},
          {"bytes", report.bytes},
          {"bytes_per_point", bytes_per_point(report)},
          {"seconds", report.seconds},
          {"points_per_second", static_cast<double>(report.input_points) / report.seconds},
          {"peak_rss_bytes", report.peak_rss_bytes},
          {"notes", report.notes},
          {"warnings", report.warnings}};
}

void print_input(const BuildReport& report) {
  for (const builder::InputReport& input : report.inputs) {
    const std::string triangles =
        input.triangles == 0 ? "" : fmt::format(", {} triangles", input.triangles);
    fmt::print("read      {}: {}, {} points{}\n", input.file, input.format, input.points,
               triangles);
  }
  std::string dropped;
  for (const auto& [cause, count] : report.dropped) {
    dropped += fmt::format("{}{} {}", dropped.empty() ? "; dropped " : ", ", count, cause);
  }
  fmt::print("kept      {} of {} points{}\n", report.kept_points, report.input_points, dropped);
  if (report.sampled_points > 0) {
    fmt::print("sampled   {} points on the faces\n", report.sampled_points);
  }
}

void print_gaps(const BuildReport& report) {
  fmt::print("gaps      up to {:.4g} mm", 1e3 * report.largest_gap_m);
  std::size_t holes = 0;
  for (const Opening& opening : report.openings) {
    holes += opening.kind == Opening::Kind::kHole ? 1 : 0;
  }
  fmt::print("; {} hole{} and {} open rim{} wider than the surface fit bridges\n", holes,
             holes == 1 ? "" : "s", report.openings.size() - holes,
             report.openings.size() - holes == 1 ? "" : "s");
  std::size_t printed = 0;
  for (const Opening& o : report.openings) {
    if (printed++ == kOpeningsPrinted) {
      break;
    }
    fmt::print("          {} of {:.4g} mm around ({:.4g}, {:.4g}, {:.4g}) m\n",
               o.kind == Opening::Kind::kHole ? "hole" : "rim", 1e3 * o.diameter_m, o.centre.x(),
               o.centre.y(), o.centre.z());
  }
}

void print(const BuildReport& report, const BuildOptions& build, const std::string& output) {
  print_input(report);
  const Eigen::Vector3d size = report.bounds.sizes();
  fmt::print("model     {:.4g} x {:.4g} x {:.4g} m, {} points, spacing {:.4g} mm\n", size.x(),
             size.y(), size.z(), report.output_points, 1e3 * report.spacing_m);
  print_gaps(report);
  for (std::size_t i = 0; i < report.material_points.size(); ++i) {
    fmt::print("material  {}: {} points\n", material_name(build, i), report.material_points[i]);
  }
  for (const std::string& note : report.notes) {
    fmt::print("note      {}\n", note);
  }
  fmt::print(
      "wrote     {}: {} bytes, {:.2f} bytes a point, in {:.2f} s ({:.3g} points/s, {} MiB)\n",
      output, report.bytes, bytes_per_point(report), report.seconds,
      static_cast<double>(report.input_points) / report.seconds, report.peak_rss_bytes >> 20U);
}

core::BlobView open_built(std::span<const std::byte> blob) {
  core::BlobView view;
  if (core::open_blob(blob, view) != core::BlobStatus::kOk) {
    throw CommandError("the blob is not valid (this is a mistake of tactree's)");
  }
  return view;
}

/// A blob that the board cannot render in time is not written.
void check_time(const BuildArguments& arguments, std::span<const std::byte> blob) {
  if (arguments.board.empty() || arguments.rate_hz <= 0.0) {
    return;
  }
  const core::BlobView view = open_built(blob);
  core::Configuration configuration;
  configuration.mode = view.is_uniform() ? core::RenderMode::kSurface : core::RenderMode::kPaper;
  configuration.rate_hz = static_cast<float>(arguments.rate_hz);
  configuration.device = slowest_or(arguments.device);
  const BoardCosts board = costs_of_board(arguments.board);
  const double highest = board.highest_rate(view.header(), configuration);
  // A tick does more at a low rate: one below the highest may be too much all the same.
  if (board.cycles(view.header(), configuration) * arguments.rate_hz > board.timing.clock_hz) {
    throw CommandError(fmt::format(
        "--rate: {} keeps up to {:.0f} Hz with this model, but not {:.6g}: a tick takes up to "
        "{:.0f} cycles, "
        "there are {:.0f} (lower --rate, or take a faster board; {} points in a ball count most)",
        arguments.board, std::floor(highest), arguments.rate_hz,
        board.cycles(view.header(), configuration), board.timing.clock_hz / arguments.rate_hz,
        view.header().points_per_ball_max));
  }
}

void build(const BuildArguments& arguments) {
  refuse_overwriting_inputs(arguments);
  const std::unique_ptr<builder::Progress> progress =
      builder::make_progress(arguments.progress, stderr);
  const std::vector<fs::path> inputs(arguments.inputs.begin(), arguments.inputs.end());
  builder::BuildResult result;
  try {
    result = builder::build_model(inputs, arguments.build, *progress);
  } catch (...) {
    progress->end();
    throw;
  }
  check_time(arguments, result.blob.bytes);
  write_file(arguments.output, std::span<const std::byte>(result.blob.bytes));
  const std::string json = json_text(to_json(result.report, arguments.build));
  for (const std::string& file : {arguments.report, arguments.json}) {
    if (!file.empty()) {
      write_file(file, json);
    }
  }
  if (!arguments.preview.empty()) {
    write_preview(arguments.preview, open_built(result.blob.bytes), result.report.openings);
  }
  print(result.report, arguments.build, arguments.output);
  for (const std::string& warning : result.report.warnings) {
    fmt::print(stderr, "tactree: warning: {}\n", warning);
  }
}

void add_frame_options(CLI::App& verb, BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  constexpr const char* kGroup = "Size and place";
  verb.add_option("--unit", build.unit_m, "what the file's numbers are: m, cm, mm, um, in, ft")
      ->transform(CLI::CheckedTransformer(kUnits).description("m|cm|mm|um|in|ft"))
      ->default_str("m")
      ->group(kGroup);
  CLI::Option* scale =
      verb.add_option("--scale", build.scale, "and enlarge by this factor")->group(kGroup);
  verb.add_option("--fit", build.fit_m,
                  "scale so that the longest edge is this many metres; centre")
      ->excludes(scale)
      ->group(kGroup);
  verb.add_flag("--center,--centre", build.centre, "put the origin in the middle")->group(kGroup);
  verb.add_option("--axis", build.up, "which of the file's axes points up: it becomes z")
      ->transform(CLI::CheckedTransformer(kAxes).description("x|y|z"))
      ->default_str("z")
      ->group(kGroup);
  verb.add_option("--crop", arguments.crop,
                  "keep this box only: xmin,ymin,zmin,xmax,ymax,zmax in the file's unit")
      ->delimiter(',')
      ->expected(6)
      ->group(kGroup);
}

void add_quality_options(CLI::App& verb, BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  constexpr const char* kGroup = "Density and surface";
  verb.add_option("--spacing", arguments.spacing,
                  "metres between points (default: a cloud's own; a mesh's size / 200; 0: "
                  "--no-resample)")
      ->group(kGroup);
  verb.add_option("--flash-budget", arguments.budget,
                  "the finest spacing whose blob is at most this large: bytes, or 896K, 1M")
      ->group(kGroup);
  verb.add_flag("--no-resample", arguments.no_resample, "keep every distinct point of a cloud")
      ->group(kGroup);
  CLI::Option* board =
      verb.add_option("--board", arguments.board,
                      "for this board: the finest model that its flash holds, where neither "
                      "--spacing nor --flash-budget is given")
          ->check(CLI::IsMember(boards_with_timing()));
  verb.add_option("--rate", arguments.rate_hz,
                  "refuse a model that the board cannot render so often, Hz")
      ->needs(board)
      ->group(kGroup);
  verb.add_option("--device", arguments.device,
                  "the device, by name or file, where it is known: some take longer")
      ->needs(board)
      ->group(kGroup);
  verb.add_option("--profile", build.profile, "surface: fitted surface; paper: as published")
      ->transform(CLI::CheckedTransformer(kProfiles).description("surface|paper"))
      ->default_str("surface")
      ->group(kGroup);
  verb.add_flag("--keep-outliers", build.keep_outliers, "keep points that are far from all others")
      ->group(kGroup);
  verb.add_flag("--flip-normals", build.flip_normals, "swap inside and outside")->group(kGroup);
  verb.add_option("--material", arguments.material,
                  "stiffness=N/m,damping=Ns/m,static=,dynamic=,texture_height=m,"
                  "texture_wavelength=m of the whole model, or a JSON file that tells them, also "
                  "by the colours of the points")
      ->group(kGroup);
}

}  // namespace

void add_build_command(CLI::App& app, int&) {
  auto arguments = std::make_shared<BuildArguments>();
  CLI::App* verb = app.add_subcommand(
      "build", "Builds a blob from scans: point clouds or meshes, several are joined");
  verb->add_option("INPUT", arguments->inputs,
                   "PLY, PCD, XYZ/PTS/CSV, OBJ, STL, OFF, glTF, ...: told by content")
      ->required();
  verb->add_option("-o,--output", arguments->output, "the blob to write")->required();
  add_frame_options(*verb, *arguments);
  add_quality_options(*verb, *arguments);
  verb->add_option("--name", arguments->build.name, "what to call it (default: the file's name)");
  verb->add_option("--threads", arguments->build.threads, "0: one a core; the result is the same")
      ->default_str("0")
      ->check(CLI::Range(0, 1024));
  verb->add_option("--progress", arguments->progress,
                   "on standard error: a line, lines, JSON, none")
      ->transform(CLI::CheckedTransformer(kProgressStyles).description("auto|plain|json|off"))
      ->default_str("auto");
  verb->add_option("--report", arguments->report, "write what was read, dropped and made as JSON");
  verb->add_option("--json", arguments->json, "the same");
  verb->add_option("--preview", arguments->preview,
                   "draw the model into this PNG file, with a scale, holes and open rims marked");
  verb->callback([arguments] {
    complete(*arguments);
    build(*arguments);
  });
}

}  // namespace tactree::cli
