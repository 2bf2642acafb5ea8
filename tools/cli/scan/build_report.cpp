#include "scan/build_report.hpp"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactree/builder/length_text.hpp"

namespace tactree::cli {
namespace {

using builder::BuildOptions;
using builder::BuildReport;
using builder::Opening;
using nlohmann::ordered_json;

constexpr std::size_t kOpeningsPrinted = 3;
constexpr std::size_t kOpeningsReported = 1000;
constexpr std::size_t kPiecesReported = 1000;

ordered_json triple(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

ordered_json openings_json(const BuildReport& report) {
  ordered_json list = ordered_json::array();
  for (const Opening& opening : report.openings) {
    if (list.size() == kOpeningsReported) {
      break;
    }
    list.push_back({{"kind", opening.kind == Opening::Kind::kHole ? "hole" : "boundary"},
                    {"diameter_m", opening.diameter_m},
                    {"centre_m", triple(opening.centre)},
                    {"points", opening.points}});
  }
  return list;
}

ordered_json orientation_json(const builder::OrientationReport& orientation) {
  ordered_json pieces = ordered_json::array();
  for (const builder::OrientedPiece& piece : orientation.pieces) {
    if (pieces.size() == kPiecesReported) {
      break;
    }
    pieces.push_back({{"points", piece.points},
                      {"centre_m", triple(piece.centre)},
                      {"basis", builder::describe(piece.basis)},
                      {"confidence", piece.confidence},
                      {"doubtful", piece.confidence < builder::kLeastConfidence}});
  }
  return {{"checked", orientation.checked},
          {"confidence", orientation.confidence},
          {"doubtful_points", orientation.doubtful_points},
          {"reversed_normals", orientation.reversed_normals},
          {"reversed_faces", orientation.reversed_faces},
          {"pieces", pieces}};
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

std::string axis_name(const BuildOptions& build) {
  return {"xyz"[static_cast<std::size_t>(build.up.value_or(builder::UpAxis::kZ))]};
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

}  // namespace

ordered_json report_json(const BuildReport& report, const BuildOptions& build) {
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
          {"backed_share", report.backed_share},
          {"openings", openings_json(report)},
          {"pieces", report.pieces},
          {"orientation", orientation_json(report.orientation)},
          {"materials", materials_json(report, build)},
          {"bounds_min_m", triple(report.bounds.min())},
          {"bounds_max_m", triple(report.bounds.max())},
          {"axis", axis_name(build)},
          {"turn_deg", build.turn_deg},
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

void print_report(const BuildReport& report, const BuildOptions& build, const std::string& output) {
  print_input(report);
  fmt::print("model     {}, {} points, spacing {}\n", builder::size_text(report.bounds.sizes()),
             report.output_points, builder::length_text(report.spacing_m));
  print_orientation(report.orientation);
  print_interior(report, build);
  print_gaps(report);
  for (std::size_t i = 0; i < report.material_points.size(); ++i) {
    fmt::print("material  {}: {} points\n", material_name(build, i), report.material_points[i]);
  }
  for (const std::string& note : report.notes) {
    fmt::print("note      {}\n", note);
  }
  fmt::print(
      "wrote     {}: {} bytes, {:.2f} bytes per point, in {:.2f} s ({:.3g} points/s, {} MiB)\n",
      output, report.bytes, bytes_per_point(report), report.seconds,
      static_cast<double>(report.input_points) / report.seconds, report.peak_rss_bytes >> 20U);
}

}  // namespace tactree::cli
