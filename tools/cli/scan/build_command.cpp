#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collection/build_collection.hpp"
#include "collection/digest.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "image/board_costs.hpp"
#include "image/own_board.hpp"
#include "option_checks.hpp"
#include "scan/board_build.hpp"
#include "scan/build_report.hpp"
#include "scan/fit_option.hpp"
#include "scan/preview.hpp"
#include "scan/reading_options.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/builder/option_names.hpp"
#include "tactree/builder/read_materials.hpp"
#include "tactree/builder/report_json.hpp"
#include "tactree/emulation/board_description.hpp"
#include "tactree/setup/pose_file.hpp"
#include "tactree/support/colour_file.hpp"
#include "tactree/support/named_output.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/spooled_input.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;
using builder::BuildOptions;

const std::map<std::string, builder::ProgressStyle> kProgressStyles = {
    {"auto", builder::ProgressStyle::kAuto},
    {"plain", builder::ProgressStyle::kPlain},
    {"json", builder::ProgressStyle::kJson},
    {"off", builder::ProgressStyle::kOff}};

struct BuildArguments {
  std::vector<std::string> inputs;
  std::string output;
  std::string report;
  std::string preview;
  std::string colours;
  std::string json;
  std::optional<std::string> fit;
  std::string pose;
  std::vector<double> crop;
  std::vector<std::string> viewpoints;
  std::optional<std::string> spacing;
  std::optional<std::string> budget;
  std::optional<std::string> memory_limit;
  std::string outliers = "3";
  std::string columns;
  BoardRequest board;
  std::string material;
  bool no_resample = false;
  bool verbose = false;
  builder::ProgressStyle progress = builder::ProgressStyle::kAuto;
  CollectionRequest collection;
  BuildOptions build;
};

[[noreturn]] void misuse(const std::string& option, const std::string& cause) {
  throw CLI::ValidationError(option, cause);
}

// A finite number without any other text.
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

// Parses 917504, 896K, 1M or 1G; K, M and G are powers of 1024 bytes.
std::uint64_t to_bytes(const std::string& option, const std::string& text, std::uint64_t most_gib) {
  double factor = 1.0;
  std::string number = text;
  const std::string suffixes = "KMG";
  const std::size_t suffix = number.empty() ? std::string::npos : suffixes.find(number.back());
  if (suffix != std::string::npos) {
    factor = std::ldexp(1.0, 10 * static_cast<int>(suffix + 1));
    number.pop_back();
  }
  const double bytes = factor * to_number(option, number);
  if (!(bytes >= 1.0) || !(bytes < std::ldexp(static_cast<double>(most_gib), 30))) {
    misuse(option, fmt::format("'{}' is not between 1 byte and {} GiB", text, most_gib));
  }
  return static_cast<std::uint64_t>(bytes);
}

Eigen::Vector3d to_position(const std::string& option, const std::string& text) {
  Eigen::Vector3d position;
  std::size_t begin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',', begin) : text.size();
    if (end == std::string::npos) {
      misuse(option, "'" + text + "' is not of the form X,Y,Z");
    }
    position[axis] = to_number(option, text.substr(begin, end - begin));
    begin = end + 1;
  }
  return position;
}

void check_board(const BoardRequest& request) {
  const bool is_file = is_board_file(request.board);
  if (!request.board.empty() && !is_file && emulation::find_board(request.board) == nullptr) {
    misuse("--board", "'" + request.board + "' is neither a board nor a file that ends in .json");
  }
  if (request.is_any() && (request.rate_hz > 0.0 || !request.device.empty())) {
    misuse(request.rate_hz > 0.0 ? "--rate" : "--device", "requires --board or --for");
  }
  if (is_file && request.firmware.empty() && request.rate_hz > 0.0) {
    misuse("--rate", "the file of a board states no cycles: give the image with --for");
  }
}

void set_spacing(const BuildArguments& arguments, BuildOptions& build) {
  build.resample = !arguments.no_resample;
  if (!arguments.spacing) {
    return;
  }
  const double spacing = to_number("--spacing", *arguments.spacing);
  if (spacing < 0.0) {
    misuse("--spacing", "must not be negative");
  }
  if (spacing > 0.0) {
    build.spacing_m = spacing;
  } else {
    build.resample = false;
  }
}

void complete(BuildArguments& arguments) {
  if (arguments.output.empty()) {
    misuse("--output", "'' is not the name of a file");
  }
  if (arguments.inputs.empty() && arguments.collection.collection.empty()) {
    throw CLI::RequiredError("INPUT");
  }
  BuildOptions& build = arguments.build;
  if (std::count(arguments.inputs.begin(), arguments.inputs.end(), support::kStandardInput) > 1) {
    misuse("INPUT", "'-' (standard input) can be given only once");
  }
  build.columns = columns_of(arguments.columns);
  if (arguments.fit) {
    set_fit(*arguments.fit, build);
  }
  if (!arguments.pose.empty()) {
    const simulation::Placement placement = setup::read_pose_file(arguments.pose);
    build.pose = placement.pose;
    build.placed_scale = placement.scale;
  }
  if (!arguments.crop.empty()) {
    const auto& c = arguments.crop;
    build.crop =
        Eigen::AlignedBox3d(Eigen::Vector3d(c[0], c[1], c[2]), Eigen::Vector3d(c[3], c[4], c[5]));
  }
  for (const std::string& viewpoint : arguments.viewpoints) {
    build.viewpoints.push_back(to_position("--viewpoint", viewpoint));
  }
  // Each object of a collection has a preview.
  const bool draws = !arguments.preview.empty() || !arguments.collection.collection.empty();
  if (!arguments.colours.empty() || draws) {
    build.keep_colours =
        arguments.colours.empty() ? builder::KeepColours::kIfAny : builder::KeepColours::kRequire;
  }
  set_spacing(arguments, build);
  if (arguments.budget) {
    build.flash_budget_bytes = to_bytes("--flash-budget", *arguments.budget, 4);
  }
  if (arguments.memory_limit) {
    build.memory_limit_bytes = to_bytes("--memory-limit", *arguments.memory_limit, 1U << 20U);
  }
  build.outlier_sigma =
      arguments.outliers == "off" ? 0.0 : to_number("--outliers", arguments.outliers);
  if (build.outlier_sigma < 1.0 && arguments.outliers != "off") {
    misuse("--outliers", "'" + arguments.outliers + "' is neither off nor a number of at least 1");
  }
  try {
    builder::check_options(build);
  } catch (const builder::OptionError& error) {
    misuse("--" + error.option(), error.what());
  }
  check_board(arguments.board);
  limit_to_board(arguments.board, build);
  if (!arguments.material.empty()) {
    build.materials = builder::read_materials(arguments.material);
  }
}

void build(BuildArguments& arguments) {
  const std::vector<fs::path> inputs(arguments.inputs.begin(), arguments.inputs.end());
  std::vector<fs::path> files = inputs;
  std::erase(files, support::kStandardInput);
  std::vector<fs::path> read = files;
  const std::string fit = arguments.fit.value_or("");
  read.insert(read.end(),
              {arguments.pose, arguments.material, arguments.board.firmware, arguments.board.board,
               arguments.board.device, fit.substr(fit.find(':') + 1)});
  const support::NamedOutput output(arguments.output);
  support::check_outputs(
      {output.file(), arguments.report, arguments.json, arguments.preview, arguments.colours},
      read);
  const std::unique_ptr<builder::Progress> progress =
      builder::make_progress(arguments.progress, stderr);
  builder::BuildResult result;
  std::optional<support::SpooledInput> standard_input;
  try {
    if (files.size() < inputs.size()) {
      progress->begin("copying standard input");
      arguments.build.standard_input = standard_input.emplace().path();
    }
    result = build_for_board(inputs, arguments.build, arguments.board, *progress);
  } catch (...) {
    progress->end();
    throw;
  }
  output.write(result.blob.bytes);
  const std::string json = builder::report_json(result.report, arguments.build);
  for (const std::string& file : {arguments.report, arguments.json}) {
    if (!file.empty()) {
      support::write_file(file, json);
    }
  }
  if (!arguments.preview.empty()) {
    write_preview(arguments.preview, view_of(result), result.report.openings, result.doubtful,
                  arguments.build.materials, result.colours);
  }
  if (!arguments.colours.empty()) {
    support::write_colours(arguments.colours, result.blob.bytes, result.colours);
  }
  print_report(result.report, arguments.build, arguments.output);
  if (arguments.verbose) {
    print_stages(result.report);
  }
  for (const std::string& warning : result.report.warnings) {
    fmt::print(stderr, "tactree: warning: {}\n", warning);
  }
}

std::string fits_in_blob(const std::string& name) {
  constexpr std::size_t kMost = sizeof(core::BlobHeader::name) - 1;
  return name.size() <= kMost ? "" : fmt::format("is longer than {} bytes", kMost);
}

void add_frame_options(CLI::App& verb, BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  constexpr const char* kGroup = "Size and position";
  verb.add_option("--unit", build.unit_m,
                  "unit of the coordinates: m, cm, mm, um, in, ft (default: as the file states, "
                  "else m)")
      ->transform(choice(builder::unit_names(), "m|cm|mm|um|in|ft"))
      ->group(kGroup);
  CLI::Option* scale =
      verb.add_option("--scale", build.scale, "additional scale factor")->group(kGroup);
  verb.add_option("--fit", arguments.fit,
                  "scale the longest edge to this length in metres, or to the workspace of a "
                  "device: device:NAME or device:FILE, device: premium; and centre")
      ->excludes(scale)
      ->group(kGroup);
  verb.add_flag("--center,--centre", build.centre,
                "move the origin to the centre of the bounding box")
      ->group(kGroup);
  verb.add_option(
          "--axis", build.up,
          "axis of the file that points up; it becomes z. With y, z becomes x, the front, and x "
          "becomes y")
      ->transform(choice(builder::axis_names(), "x|y|z"))
      ->default_str("z")
      ->group(kGroup);
  verb.add_option("--turn", build.turn_deg,
                  "then turn the model about z by this angle, degrees, counterclockwise seen from "
                  "above; its front is the side of +x, which faces the user of the device")
      ->capture_default_str()
      ->group(kGroup);
  verb.add_option("--pose", arguments.pose,
                  "pose file, as the page of view saves it, applied last: the coordinates of the "
                  "model are then those of the device's frame (simulate and view: --origin 0 0 0)")
      ->check(existing_file())
      ->group(kGroup);
  verb.add_option("--crop", arguments.crop,
                  "keep only this box: xmin,ymin,zmin,xmax,ymax,zmax in the unit of the file")
      ->delimiter(',')
      ->expected(6)
      ->group(kGroup);
}

void add_quality_options(CLI::App& verb, BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  constexpr const char* kGroup = "Density and surface";
  verb.add_option("--spacing", arguments.spacing,
                  "metres between points (default: that of a cloud; size of a mesh / 200; 0: as "
                  "--no-resample)")
      ->group(kGroup);
  verb.add_option("--flash-budget", arguments.budget,
                  "choose the finest spacing whose blob has at most this size: bytes, or 896K, 1M")
      ->group(kGroup);
  verb.add_flag("--no-resample", arguments.no_resample, "keep every distinct point of a cloud")
      ->group(kGroup);
  verb.add_option("--board", arguments.board.board,
                  "build for this board, or for that of a JSON file: the model with the finest "
                  "spacing that fits its flash, unless --spacing or --flash-budget is given")
      ->type_name(fmt::format("{}|FILE.json", fmt::join(boards_with_timing(), "|")));
  verb.add_option("--for", arguments.board.firmware,
                  "build for this firmware image, an ELF file: the model with the finest spacing "
                  "that fits the room in it; --rate uses the cycles of a tick that it states")
      ->check(existing_file());
  verb.add_option("--rate", arguments.board.rate_hz,
                  "build the model with the finest spacing that the board also renders at this "
                  "rate, Hz; refuse a --spacing or --flash-budget that is too fine for the rate")
      ->check(within(1.0, 1e6))
      ->group(kGroup);
  verb.add_option("--device", arguments.board.device,
                  "device for --rate, by name or file (default: the kind with the longest tick)")
      ->group(kGroup);
  verb.add_option("--profile", build.profile, "surface: fitted surface; paper: method of the paper")
      ->transform(choice(builder::profile_names(), "surface|paper"))
      ->default_str("surface")
      ->group(kGroup);
  verb.add_option("--material", arguments.material,
                  "stiffness=N/m,damping=Ns/m,static=,dynamic=,texture_height=m,"
                  "texture_wavelength=m of the whole model, or a JSON file with one material or "
                  "one per colour")
      ->group(kGroup);
}

void add_surface_options(CLI::App& verb, BuildArguments& arguments) {
  BuildOptions& build = arguments.build;
  constexpr const char* kGroup = "Points and orientation";
  verb.add_option("--outliers", arguments.outliers,
                  "drop points that are off the surface by more than this many times the noise of "
                  "the scan; off: keep all (default: 3)")
      ->group(kGroup);
  CLI::Option* largest = verb.add_flag("--keep-largest", build.keep_largest,
                                       "keep only the largest connected component")
                             ->group(kGroup);
  verb.add_option("--min-piece", build.min_piece,
                  "drop connected components with fewer points than this; of a mesh: vertices")
      ->excludes(largest)
      ->group(kGroup);
  verb.add_option("--orient", build.orient,
                  "side of the surface that is outside: outward: away from the body; viewpoint: "
                  "towards the scanner; up: towards +z; given: as the file says, unchecked; auto: "
                  "by viewpoints if there are any, else outward, and sheets up")
      ->transform(choice(builder::orientation_names(), "auto|outward|viewpoint|up|given"))
      ->default_str("auto")
      ->group(kGroup);
  verb.add_option("--viewpoint", arguments.viewpoints,
                  "position of the scanner, X,Y,Z in the unit of the file; may be repeated")
      ->group(kGroup);
  verb.add_option("--two-sided", build.two_sided_m,
                  "the scan is a sheet: build a body of this thickness in metres, which can be "
                  "touched from both sides")
      ->group(kGroup);
  verb.add_flag("--flip-normals", build.flip_normals, "reverse all normals, as the last step")
      ->group(kGroup);
}

/// After all other options.
void add_collection_options(CLI::App& verb, BuildArguments& arguments) {
  constexpr const char* kGroup = "Collections";
  CollectionRequest& collection = arguments.collection;
  CLI::Option* place =
      verb.add_option("--collection", collection.collection,
                      "build a blob of each scan that this text file lists, one path per line, or "
                      "that is below this folder; skip those that are up to date")
          ->group(kGroup);
  for (const char* const single : {"INPUT", "--report", "--preview", "--colours", "--verbose"}) {
    place->excludes(verb.get_option(single));
  }
  CLI::Option* part =
      verb.add_option("--part", collection.part,
                      "K/N: build only the K-th of N parts (default: as the environment of a Slurm "
                      "array job, of Open MPI or of PMI states, else 1/1)")
          ->needs(place)
          ->group(kGroup);
  verb.add_flag("--collect", collection.collect,
                "build nothing, write manifest.csv and index.html after the last part")
      ->needs(place)
      ->excludes(part)
      ->group(kGroup);
}

}  // namespace

void add_build_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<BuildArguments>();
  CLI::App* verb = app.add_subcommand(
      "build", "Builds a blob from one or several scans: point clouds or meshes");
  verb->add_option("INPUT", arguments->inputs,
                   "PLY, PCD, PTX, E57, LAS, XYZ/PTS/CSV, OBJ, STL, OFF, glTF, 3MF, ...; "
                   "recognised by content. -: standard input, copied to a file in TMPDIR first");
  add_format_option(*verb, arguments->build.format);
  verb->add_option("-o,--output", arguments->output,
                   "blob to write; -: standard output; with --collection the folder of the blobs")
      ->required();
  add_columns_option(*verb, arguments->columns);
  add_frame_options(*verb, *arguments);
  add_quality_options(*verb, *arguments);
  add_surface_options(*verb, *arguments);
  verb->add_option("--name", arguments->build.name,
                   "name of the model (default: that of the first file)")
      ->check(fits_in_blob);
  verb->add_option("--threads", arguments->build.threads,
                   "number of threads, 0: one per core; does not change the result")
      ->default_str("0")
      ->check(within(0, 1024));
  verb->add_option(
      "--memory-limit", arguments->memory_limit,
      "memory that the build may take: bytes, or 800M, 8G (default: half of that of the "
      "computer). Larger clouds are thinned evenly while they are read");
  verb->add_option("--progress", arguments->progress,
                   "progress on standard error: one line, lines, JSON, none")
      ->transform(choice(kProgressStyles, "auto|plain|json|off"))
      ->default_str("auto");
  verb->add_flag("--verbose", arguments->verbose,
                 "also print time, CPU time, points and peak memory of each step");
  verb->add_option("--report", arguments->report,
                   "write a report of the build as JSON to this file");
  verb->add_option("--json", arguments->json,
                   "same as --report; with --collection results and failures");
  verb->add_option(
          "--preview", arguments->preview,
          "write a picture of the model to this PNG file, with a scale and marked openings")
      ->check(written_as(".png"));
  verb->add_option("--colours,--colors", arguments->colours,
                   "write the colours of the scan to this file, for view --colours; a blob has "
                   "none");
  add_collection_options(*verb, *arguments);
  verb->callback([verb, arguments, &exit_code] {
    complete(*arguments);
    CollectionRequest& collection = arguments->collection;
    if (collection.collection.empty()) {
      build(*arguments);
      return;
    }
    collection.output = arguments->output;
    collection.json = arguments->json;
    collection.options_digest = digest_of_options(*verb);
    const bool is_complete =
        build_collection(collection, arguments->build, arguments->board, arguments->progress);
    exit_code = is_complete ? kExitOk : kExitFailed;
  });
}

}  // namespace tactree::cli
