#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "scan/reading_options.hpp"
#include "tactree/builder/progress.hpp"
#include "tactree/evaluation/evaluation.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/viewer/markdown.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

// From the Debian packages glmark2-data and assimp-testmodels.
constexpr const char* kDefaultScans[] = {
    "/usr/share/glmark2/models/bunny.obj",
    "/usr/share/glmark2/models/horse.3ds",
    "/usr/share/glmark2/models/cat.3ds",
    "/usr/share/glmark2/models/asteroid-high.3ds",
    "/usr/share/assimp/models/3DS/fels.3ds",
    "/usr/share/assimp/models/Collada/duck.dae",
    "/usr/share/assimp/models/MS3D/jeep1.ms3d",
    "/usr/share/assimp/models/PLY/Wuson.ply",
    "/usr/share/assimp/models/STL/Spider_binary.stl",
    "/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb",
};

struct EvaluateOptions {
  evaluation::Options evaluation;
  std::vector<std::string> scans;
  std::string columns;
  std::string folder;
  bool no_scans = false;
  bool require_targets = false;
  std::string json;
  std::string report;
  std::string html;
};

std::vector<fs::path> files_below(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_regular_file(error)) {
      files.push_back(entry.path());
    }
  }
  if (error) {
    throw support::UserError(
        fmt::format("{}: cannot list the folder: {}", folder, error.message()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> scans_of(const EvaluateOptions& options) {
  std::vector<fs::path> scans(options.scans.begin(), options.scans.end());
  for (const fs::path& scan : scans) {
    if (!fs::exists(scan)) {
      throw support::UserError(fmt::format("{}: no such file (check the path)", scan.string()));
    }
  }
  if (!options.folder.empty()) {
    const std::vector<fs::path> found = files_below(options.folder);
    scans.insert(scans.end(), found.begin(), found.end());
  }
  if (scans.empty() && !options.no_scans) {
    std::copy_if(std::begin(kDefaultScans), std::end(kDefaultScans), std::back_inserter(scans),
                 [](const fs::path& scan) { return fs::exists(scan); });
  }
  return scans;
}

/// A file that the user named must be a scan; among those of a folder, others are listed.
void require_scans(const evaluation::Result& result) {
  for (const evaluation::ScanResult& scan : result.scans) {
    if (!scan.error.empty()) {
      throw support::UserError(scan.error);
    }
  }
}

/// Writes the page, and its pictures to a folder with the same name.
void write_report(const fs::path& file, const evaluation::Result& result) {
  const fs::path pictures = file.stem();
  const fs::path folder = file.parent_path() / pictures;
  const std::map<std::string, std::string> plots = evaluation::plots(result);
  std::error_code error;
  if (!plots.empty()) {
    fs::create_directories(folder, error);
  }
  if (error) {
    throw support::UserError(
        fmt::format("{}: cannot create the folder: {}", folder.string(), error.message()));
  }
  for (const auto& [name, svg] : plots) {
    support::write_file(folder / name, svg);
  }
  support::write_file(file, evaluation::to_markdown(result, pictures.string()));
}

/// The report with the Z-width and the openings of the scans as one file with embedded pictures.
std::string html_report(const evaluation::Result& result) {
  std::map<std::string, std::string> pictures = evaluation::plots(result);
  pictures.merge(evaluation::hole_maps(result));
  if (!result.options.scans_only) {
    pictures["z_width.svg"] = evaluation::z_width_svg(result.options.quick);
  }
  viewer::MarkdownTargets targets;
  targets.picture = [&pictures](std::string_view file) {
    const auto found = pictures.find(std::string(file.substr(file.rfind('/') + 1)));
    return found == pictures.end() ? std::string() : found->second;
  };
  const char* const z_width =
      "\n"
      "## Z-width\n"
      "Largest stable stiffness of a wall without a hand, as a function of "
      "the wall's damping and the rate.\n"
      "\n"
      "![Z-width](z_width.svg)\n";
  const std::string text = evaluation::to_markdown(result, "pictures") +
                           (result.options.scans_only ? "" : z_width) +
                           evaluation::holes_markdown(result);
  return viewer::html_page("Evaluation results", viewer::markdown_html(text, targets));
}

void evaluate(EvaluateOptions& options, int& exit_code) {
  options.evaluation.columns = columns_of(options.columns);
  options.evaluation.scans = scans_of(options);
  const std::vector<fs::path> inputs(options.evaluation.scans.begin(),
                                     options.evaluation.scans.end());
  support::check_outputs({options.json, options.html, options.report}, inputs);
  const auto progress = builder::make_progress(builder::ProgressStyle::kAuto, stderr);
  options.evaluation.scans_only = !options.scans.empty();
  const evaluation::Result result = evaluation::evaluate(options.evaluation, *progress);
  if (options.evaluation.scans_only) {
    require_scans(result);
  }
  if (!options.json.empty()) {
    support::write_file(options.json, evaluation::to_json(result));
  }
  if (!options.report.empty()) {
    write_report(options.report, result);
  }
  if (!options.html.empty()) {
    support::write_file(options.html, html_report(result));
  }
  fmt::print("{}", evaluation::to_markdown(result, ""));
  exit_code = options.require_targets && !result.all_met() ? kExitFailed : kExitOk;
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* verb = app.add_subcommand(
      "evaluate",
      "Measures the accuracy of both modes: the paper's Tables 1 and 2; distance, normal and "
      "force\n"
      "on shapes with known geometry; contact in creases, on stairs, in rooms and on two bodies; "
      "the\n"
      "closed loop; and real models: against a double precision reference, slid over and crossed. "
      "Deterministic; some "
      "minutes,\n"
      "or seconds with --quick. Prints the tables and targets.");
  verb->add_flag("--quick", options->evaluation.quick, "fewer probes: faster, less precise");
  verb->add_option("--seed", options->evaluation.seed, "seed of the random numbers")
      ->capture_default_str();
  CLI::Option* scan = verb->add_option("--scan", options->scans,
                                       "report only on these scans: points kept, orientation, "
                                       "holes, force during slides, crossings; takes "
                                       "seconds. Refuses files that are not scans");
  add_format_option(*verb, options->evaluation.format)->needs(scan);
  add_columns_option(*verb, options->columns)->needs(scan);
  verb->add_option("--scans", options->folder,
                   "evaluate every readable scan below this folder, scaled to 100 mm")
      ->excludes(scan);
  verb->add_flag("--no-scans", options->no_scans,
                 "compare no scans (default: ten models of the Debian packages glmark2-data and "
                 "assimp-testmodels, those that are present)")
      ->excludes(scan);
  verb->add_flag("--require-targets", options->require_targets, "exit code 1 if a target is missed")
      ->excludes(scan);
  verb->add_option("--json", options->json, "write all values to this file");
  verb->add_option("--report", options->report,
                   "write a Markdown page to this file, its plots to a folder of the same name");
  verb->add_option(
      "--html", options->html,
      "write a self-contained HTML page to this file, with maps of the Z-width and of the "
      "holes of each scan");
  verb->callback([options, &exit_code] { evaluate(*options, exit_code); });
}

}  // namespace tactree::cli
