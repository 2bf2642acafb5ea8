#include "tactree/builder/report_json.hpp"

#include <nlohmann/json.hpp>

namespace tactree::builder {
namespace {

using nlohmann::ordered_json;

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

ordered_json orientation_json(const OrientationReport& orientation) {
  ordered_json pieces = ordered_json::array();
  for (const OrientedPiece& piece : orientation.pieces) {
    if (pieces.size() == kPiecesReported) {
      break;
    }
    pieces.push_back({{"points", piece.points},
                      {"centre_m", triple(piece.centre)},
                      {"basis", describe(piece.basis)},
                      {"confidence", piece.confidence},
                      {"doubtful", piece.confidence < kLeastConfidence}});
  }
  return {{"checked", orientation.checked},
          {"confidence", orientation.confidence},
          {"doubtful_points", orientation.doubtful_points},
          {"reversed_normals", orientation.reversed_normals},
          {"reversed_faces", orientation.reversed_faces},
          {"pieces", pieces}};
}

ordered_json materials_json(const BuildReport& report, const BuildOptions& build) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < report.material_points.size(); ++i) {
    list.push_back(
        {{"name", material_name(*build.materials, i)}, {"points", report.material_points[i]}});
    if (i > 0) {
      list.back()["rgb"] = build.materials->colours[i - 1].colour;
      list.back()["tolerance"] = build.materials->colours[i - 1].tolerance;
    }
  }
  return list;
}

/// Row by row; null if there is none.
ordered_json pose_json(const BuildOptions& build) {
  ordered_json rows;
  for (Eigen::Index i = 0; i < 16 && build.pose; ++i) {
    rows.push_back(build.pose->matrix()(i / 4, i % 4));
  }
  return rows;
}

ordered_json stages_json(const BuildReport& report) {
  ordered_json list = ordered_json::array();
  for (const StageReport& stage : report.stages) {
    list.push_back({{"name", stage.name},
                    {"seconds", stage.seconds},
                    {"cpu_seconds", stage.cpu_seconds},
                    {"points", stage.points},
                    {"peak_rss_bytes", stage.peak_rss_bytes}});
  }
  return list;
}

ordered_json colours_json(const BuildReport& report) {
  ordered_json list = ordered_json::array();
  for (const ColourCount& count : report.colours) {
    list.push_back({{"rgb", count.colour}, {"points", count.points}});
  }
  return list;
}

}  // namespace

std::string axis_name(const BuildOptions& build) {
  return {"xyz"[static_cast<std::size_t>(build.up.value_or(UpAxis::kZ))]};
}

double bytes_per_point(const BuildReport& report) {
  return static_cast<double>(report.bytes) / static_cast<double>(report.output_points);
}

std::string report_json(const BuildReport& report, const BuildOptions& build) {
  ordered_json inputs = ordered_json::array();
  for (const InputReport& input : report.inputs) {
    inputs.push_back({{"file", input.file},
                      {"format", input.format},
                      {"points", input.points},
                      {"triangles", input.triangles}});
  }
  ordered_json dropped = ordered_json::object();
  for (const auto& [cause, count] : report.dropped) {
    dropped[cause] = count;
  }
  const ordered_json json{
      {"inputs", inputs},
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
      {"colours", colours_json(report)},
      {"bounds_min_m", triple(report.bounds.min())},
      {"bounds_max_m", triple(report.bounds.max())},
      {"axis", axis_name(build)},
      {"turn_deg", build.turn_deg},
      {"pose", pose_json(build)},
      {"pose_scale", build.placed_scale},
      {"source_scale", report.source_scale},
      {"source_origin", triple(report.source_origin)},
      {"bytes", report.bytes},
      {"bytes_per_point", bytes_per_point(report)},
      {"stages", stages_json(report)},
      {"seconds", report.seconds},
      {"points_per_second", static_cast<double>(report.input_points) / report.seconds},
      {"peak_rss_bytes", report.peak_rss_bytes},
      {"notes", report.notes},
      {"warnings", report.warnings}};
  // Names of files may contain bytes that are not UTF-8.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace tactree::builder
