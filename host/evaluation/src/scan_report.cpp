#include "scan_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tactree/builder/length_text.hpp"

namespace tactree::evaluation {
namespace {

using builder::length_text;

std::string dropped_text(const ScanResult& scan) {
  std::string text;
  for (const auto& [cause, count] : scan.dropped) {
    text += fmt::format("{}{} {}", text.empty() ? "; dropped: " : ", ", count, cause);
  }
  return text;
}

std::string openings_text(const ScanResult& scan) {
  const auto holes = std::count_if(
      scan.openings.begin(), scan.openings.end(),
      [](const builder::Opening& o) { return o.kind == builder::Opening::Kind::kHole; });
  const std::string widest = scan.openings.empty()
                                 ? ""
                                 : fmt::format("; the widest is {} wide, at {}",
                                               length_text(scan.openings[0].diameter_m, 3),
                                               builder::place_text(scan.openings[0].centre));
  return fmt::format(
      "holes: {}, open boundaries: {}, wider than the {} that the surface fit bridges{}", holes,
      static_cast<std::ptrdiff_t>(scan.openings.size()) - holes, length_text(scan.bridged_m, 3),
      widest);
}

std::string orientation_text(const ScanResult& scan) {
  if (!scan.orientation_checked) {
    return "not checked: the normals were taken from the file";
  }
  return fmt::format("confidence {:.0f} %; components: {}; points of doubtful components: {}",
                     std::floor(100.0 * scan.orientation_confidence), scan.pieces,
                     scan.doubtful_points);
}

std::string slides_text(const SlideScores& s) {
  if (s.slides == 0) {
    return "none: nowhere is the surface large enough";
  }
  return fmt::format(
      "{} slides, {} ticks; contact lost in {}; force {:.3g} N expected, error {:.3g} "
      "N rms, largest force {:.3g} N; jump of the force {:.3g} N in 99 % of the ticks, {:.3g} N in "
      "99.9 %, at most {:.3g} N",
      s.slides, s.ticks, s.lost, s.expected_N, s.force_error_rms_N, s.force_max_N,
      s.force_step_99_N, s.force_step_999_N, s.force_step_N);
}

std::string crossings_text(const SlideScores& s) {
  return fmt::format(
      "{} at 0.1, 0.5 and 1 m/s, 1000 ticks a second; noticed up to two ticks later than within 1 "
      "mm: {}; missed: {}",
      s.crossings, s.late, s.missed);
}

}  // namespace

std::string scan_report(const Result& result) {
  std::string page = fmt::format(
      "# Evaluation of scans\n\nEach scan was built with the default options of `tactree build`. "
      "The hand slides over the model in random directions, at a constant depth and with a "
      "stiffness of 1 N/mm: where the surface is smooth, its force is constant. It fades at holes "
      "and at the edges of sheets. A jump is the change between two ticks, less the change that is "
      "due to the movement of the hand. The values come from `tactree evaluate{} --scan`, seed "
      "{}.\n",
      result.options.quick ? " --quick" : "", result.options.seed);
  for (const ScanResult& scan : result.scans) {
    fmt::format_to(
        std::back_inserter(page),
        "\n## {}\n| | |\n|---|---|\n| points | {} of {} kept{}; {} in the model, spacing {} |\n"
        "| outside | {} |\n| openings | {} |\n| slides | {} |\n"
        "| crossings | {} |\n"
        "| computed surface | {:.1f} % of the probes within a spacing of the surface have a "
        "result; against a reference in double precision, the error of the point is {} rms, of the "
        "normal {:.2g} degrees rms, away from creases |\n",
        scan.name, scan.kept_points, scan.input_points, dropped_text(scan), scan.points,
        length_text(scan.spacing_m, 3), orientation_text(scan), openings_text(scan),
        slides_text(scan.slides), crossings_text(scan.slides), 100.0 * scan.scores.get("answered"),
        length_text(scan.scores.get("smooth_distance_rms_m"), 3),
        scan.scores.get("smooth_normal_rms_deg"));
    for (const std::string& note : scan.notes) {
      page += "\nNote: " + note + "\n";
    }
    for (const std::string& warning : scan.warnings) {
      page += "\nWarning: " + warning + "\n";
    }
  }
  return page;
}

}  // namespace tactree::evaluation
