#include "evaluate_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "command.hpp"
#include "output_file.hpp"
#include "tactree/builder/progress.hpp"
#include "tactree/evaluation/evaluation.hpp"
#include "tactree/viewer/markdown.hpp"

namespace tactree::cli {
namespace {

namespace fs = std::filesystem;

// From the package glmark2-data.
constexpr const char* kDefaultScan = "/usr/share/glmark2/models/bunny.obj";

struct EvaluateOptions {
  evaluation::Options evaluation;
  std::vector<std::string> scans;
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
    throw CommandError(fmt::format("{}: cannot be listed: {}", folder, error.message()));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> scans_of(const EvaluateOptions& options) {
  std::vector<fs::path> scans(options.scans.begin(), options.scans.end());
  for (const fs::path& scan : scans) {
    if (!fs::exists(scan)) {
      throw CommandError(fmt::format("{}: there is no such file", scan.string()));
    }
  }
  if (!options.folder.empty()) {
    const std::vector<fs::path> found = files_below(options.folder);
    scans.insert(scans.end(), found.begin(), found.end());
  }
  if (scans.empty() && !options.no_scans && fs::exists(kDefaultScan)) {
    scans.emplace_back(kDefaultScan);
  }
  return scans;
}

/// The page, and its pictures in a folder beside it.
void write_report(const fs::path& file, const evaluation::Result& result) {
  const fs::path pictures = file.stem();
  const fs::path folder = file.parent_path() / pictures;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw CommandError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  for (const auto& [name, svg] : evaluation::plots(result)) {
    write_file(folder / name, svg);
  }
  write_file(file, evaluation::to_markdown(result, pictures.string()));
}

/// The same, the Z-width and where the scans end in one file, its pictures within.
std::string html_report(const evaluation::Result& result) {
  std::map<std::string, std::string> pictures = evaluation::plots(result);
  pictures.merge(evaluation::hole_maps(result));
  pictures["z_width.svg"] = evaluation::z_width_svg(result.options.quick);
  viewer::MarkdownTargets targets;
  targets.picture = [&pictures](std::string_view file) {
    const auto found = pictures.find(std::string(file.substr(file.rfind('/') + 1)));
    return found == pictures.end() ? std::string() : found->second;
  };
  const std::string text = evaluation::to_markdown(result, "pictures") +
                           "\n## Z-width\nThe stiffest wall that is stable when nobody holds the "
                           "device, by its damping and the loop's rate.\n\n"
                           "![Z-width](z_width.svg)\n" +
                           evaluation::holes_markdown(result);
  return viewer::html_page("How good is the touch?", viewer::markdown_html(text, targets));
}

void evaluate(EvaluateOptions& options, int& exit_code) {
  options.evaluation.scans = scans_of(options);
  const auto progress = builder::make_progress(builder::ProgressStyle::kAuto, stderr);
  const evaluation::Result result = evaluation::evaluate(options.evaluation, *progress);
  if (!options.json.empty()) {
    write_file(options.json, evaluation::to_json(result));
  }
  if (!options.report.empty()) {
    write_report(options.report, result);
  }
  if (!options.html.empty()) {
    write_file(options.html, html_report(result));
  }
  fmt::print("{}", evaluation::to_markdown(result, ""));
  exit_code = options.require_targets && !result.all_met() ? kExitFailed : kExitOk;
}

}  // namespace

void add_evaluate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* verb = app.add_subcommand(
      "evaluate",
      "Measures how good the touch is, in both modes: the paper's Tables 1 and 2, distance, "
      "normal\n"
      "and force on shapes whose truth is known, the closed loop, and real scans against a double\n"
      "precision reference. Deterministic; some minutes, or seconds with --quick. Prints the "
      "tables\n"
      "and each target with its figure.");
  verb->add_flag("--quick", options->evaluation.quick, "fewer probes: all figures, less precise");
  verb->add_option("--seed", options->evaluation.seed, "of every random choice")
      ->capture_default_str();
  verb->add_option("--scan", options->scans,
                   fmt::format("scans to compare (default: {}, where it is)", kDefaultScan));
  verb->add_option("--scans", options->folder, "compare every readable scan below this folder");
  verb->add_flag("--no-scans", options->no_scans, "leave the default scan out");
  verb->add_flag("--require-targets", options->require_targets,
                 "exit code 1 when a target is missed");
  verb->add_option("--json", options->json, "write all figures to this file");
  verb->add_option("--report", options->report,
                   "write a Markdown page to this file, its plots into a folder of its name");
  verb->add_option("--html", options->html,
                   "write all of it to this file, a page for a browser that needs no other file; "
                   "with maps of the Z-width and of the holes of each scan");
  verb->callback([options, &exit_code] { evaluate(*options, exit_code); });
}

}  // namespace tactree::cli
