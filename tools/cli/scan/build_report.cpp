#include "scan/build_report.hpp"

#include <fmt/core.h>

#include <cmath>

#include "tactree/builder/length_text.hpp"
#include "tactree/builder/report_json.hpp"

namespace tactree::cli {
namespace {

using builder::BuildOptions;
using builder::BuildReport;
using builder::Opening;

constexpr std::size_t kOpeningsPrinted = 3;
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
  fmt::print("gaps      up to {}", builder::length_text(report.largest_gap_m));
  std::size_t holes = 0;
  for (const Opening& opening : report.openings) {
    holes += opening.kind == Opening::Kind::kHole ? 1 : 0;
  }
  fmt::print("; {} hole{} and {} open boundar{} too wide for the surface fit\n", holes,
             holes == 1 ? "" : "s", report.openings.size() - holes,
             report.openings.size() - holes == 1 ? "y" : "ies");
  std::size_t printed = 0;
  for (const Opening& o : report.openings) {
    if (printed++ == kOpeningsPrinted) {
      break;
    }
    fmt::print("          {} of {} at {}\n", o.kind == Opening::Kind::kHole ? "hole" : "boundary",
               builder::length_text(o.diameter_m), builder::place_text(o.centre));
  }
}

void print_orientation(const builder::OrientationReport& orientation) {
  if (!orientation.checked || orientation.pieces.empty()) {
    return;
  }
  fmt::print("outside   confidence {:.0f} %; {} component{}, the largest {}\n",
             std::floor(100.0 * orientation.confidence), orientation.pieces.size(),
             orientation.pieces.size() == 1 ? "" : "s",
             builder::describe(orientation.pieces.front().basis));
}

void print_interior(const BuildReport& report, const BuildOptions& build) {
  if (build.profile == core::Profile::kPaper) {
    return;
  }
  if (report.backed_share == 0.0) {
    fmt::print("inside    none: the model is a sheet, which a hand feels from both sides\n");
    return;
  }
  fmt::print("inside    behind {:.0f} % of the surface", 100.0 * report.backed_share);
  fmt::print("{}\n", report.backed_share < 0.995
                         ? "; the rest are sheets, which a hand feels from both sides"
                         : "");
}

void print_colours(const BuildReport& report, const BuildOptions& build) {
  if (!report.colours.empty() && build.keep_colours != builder::KeepColours::kRequire) {
    fmt::print(
        "colours   the scan has some: --colours FILE keeps them for view and info --preview\n");
  }
}

}  // namespace

void print_stages(const BuildReport& report) {
  for (const builder::StageReport& stage : report.stages) {
    fmt::print("time      {:8.2f} s, CPU {:8.2f} s  {}", stage.seconds, stage.cpu_seconds,
               stage.name);
    if (stage.points > 0) {
      fmt::print(": {} points", stage.points);
    }
    fmt::print(", peak {} MiB\n", stage.peak_rss_bytes >> 20U);
  }
}

void print_report(const BuildReport& report, const BuildOptions& build, const std::string& output) {
  print_input(report);
  fmt::print("model     {}, {} points, spacing {}\n", builder::size_text(report.bounds.sizes()),
             report.output_points, builder::length_text(report.spacing_m));
  print_orientation(report.orientation);
  print_interior(report, build);
  print_gaps(report);
  for (std::size_t i = 0; i < report.material_points.size(); ++i) {
    fmt::print("material  {}: {} points\n", builder::describe_material(*build.materials, i),
               report.material_points[i]);
  }
  print_colours(report, build);
  for (const std::string& note : report.notes) {
    fmt::print("note      {}\n", note);
  }
  fmt::print(
      "wrote     {}: {} bytes, {:.2f} bytes per point, in {:.2f} s ({:.3g} points/s, {} MiB)\n",
      output, report.bytes, builder::bytes_per_point(report), report.seconds,
      static_cast<double>(report.input_points) / report.seconds, report.peak_rss_bytes >> 20U);
}

}  // namespace tactree::cli
