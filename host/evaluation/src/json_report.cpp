#include <cmath>
#include <nlohmann/json.hpp>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json scores_json(const Scores& scores) {
  Json json = Json::object();
  for (const auto& [name, value] : scores.all()) {
    json[name] = number(value);
  }
  return json;
}

Json counts(const std::array<DetectionRow::Count, 2>& modes) {
  Json json;
  for (const Mode mode : {kSurface, kPaper}) {
    json[kModeNames[mode]] = {{"accuracy", modes[mode].accuracy()},
                              {"false_positives", modes[mode].false_positives},
                              {"false_negatives", modes[mode].false_negatives}};
  }
  return json;
}

Json detection_row(const DetectionRow& row) {
  Json printed = nullptr;
  if (row.paper_accuracy > 0.0) {
    printed = {{"accuracy", row.paper_accuracy},
               {"false_positives", row.paper_false_positives},
               {"false_negatives", row.paper_false_negatives}};
  }
  return {{"separation_m", row.separation_m},
          {"dynamic", row.dynamic},
          {"printed", printed},
          {"tracing", counts(row.tracing)},
          {"hovering", counts(row.hovering)}};
}

Json tables(const Result& result) {
  Json rows = Json::array();
  for (const DetectionRow& row : result.detection) {
    rows.push_back(detection_row(row));
  }
  const DistanceTable& d = result.distances;
  const Json two = {
      {"printed", {{"smallest_m", 0.0}, {"biggest_m", 34.1795e-6}, {"mean_m", 1.9716e-6}}},
      {"paper", {{"biggest_m", d.paper_max_m}, {"mean_m", d.paper_mean_m}}},
      {"paper_literal_without_point", d.literal_without_point},
      {"surface", {{"biggest_m", d.surface_max_m}, {"mean_m", d.surface_mean_m}}},
      {"nearest_query", {{"biggest_m", d.nearest_max_m}}}};
  return {{"1", rows}, {"2", two}};
}

Json loop(const LoopResult& l) {
  Json json = {{"vibration_m_s2", number(l.vibration_m_s2[kSurface])}};
  Json stiffness = Json::object();
  Json modes = {{"surface", Json::object()}, {"paper", Json::object()}};
  Json expected = Json::object();
  for (const LoopResult::Stiffness& row : l.stiffness) {
    const std::string rate = std::to_string(std::lround(row.rate_hz));
    stiffness[rate] = number(row.max_N_m[kSurface]);
    expected[rate] = number(row.expected_N_m);
    for (const Mode mode : {kSurface, kPaper}) {
      modes[kModeNames[mode]]["stiffness_max_N_m"][rate] = number(row.max_N_m[mode]);
    }
  }
  json["stiffness_max_N_m"] = stiffness;
  json["stiffness_expected_N_m"] = expected;
  for (const Mode mode : {kSurface, kPaper}) {
    modes[kModeNames[mode]]["vibration_m_s2"] = number(l.vibration_m_s2[mode]);
    json[kModeNames[mode]] = modes[kModeNames[mode]];
  }
  json["limits"] = Json::array();
  for (const LoopResult::Limit& c : l.limits) {
    json["limits"].push_back({{"rate_hz", c.rate_hz},
                              {"delay_s", c.delay_s},
                              {"hand_Ns_m", c.hand_Ns_m},
                              {"wall_Ns_m", c.wall_Ns_m},
                              {"formula_N_m", number(c.formula_N_m)},
                              {"measured_N_m", number(c.measured_N_m)},
                              {"passive_N_m", number(c.passive_N_m)}});
  }
  return json;
}

Json creases(const std::vector<CreaseResult>& rows) {
  Json json = Json::object();
  for (const CreaseResult& row : rows) {
    json[row.name] = {{"ticks", row.ticks},
                      {"lost", row.lost},
                      {"late_m", row.late_m},
                      {"fast_late_m", row.fast_late_m},
                      {"off_m", row.rests ? number(row.off_m) : nullptr},
                      {"step_N", row.step_N}};
  }
  return json;
}

Json inside(const Result& result) {
  Json json = Json::object();
  for (const InsideResult& row : result.inside) {
    json[row.name] = {
        {"starts", row.starts}, {"shown", row.shown}, {"force_N", row.force_N}, {"felt", row.felt}};
  }
  return json;
}

Json slides(const SlideScores& s) {
  return {{"slides", s.slides},
          {"ticks", s.ticks},
          {"contact_lost", s.lost},
          {"expected_N", s.expected_N},
          {"force_error_rms_N", number(s.force_error_rms_N)},
          {"force_max_N", s.force_max_N},
          {"force_step_N", s.force_step_N},
          {"force_step_99_N", s.force_step_99_N},
          {"force_step_999_N", s.force_step_999_N},
          {"crossings", s.crossings},
          {"crossings_late", s.late},
          {"crossings_missed", s.missed}};
}

Json openings(const ScanResult& scan) {
  Json list = Json::array();
  for (const builder::Opening& o : scan.openings) {
    list.push_back({{"kind", o.kind == builder::Opening::Kind::kHole ? "hole" : "boundary"},
                    {"diameter_m", o.diameter_m},
                    {"centre_m", {o.centre.x(), o.centre.y(), o.centre.z()}}});
  }
  return list;
}

Json scans(const Result& result) {
  Json json = Json::object();
  for (const ScanResult& scan : result.scans) {
    Json entry = scores_json(scan.scores);
    entry["input_points"] = scan.input_points;
    entry["kept_points"] = scan.kept_points;
    entry["dropped"] = scan.dropped;
    entry["points"] = scan.points;
    entry["orientation"] = {{"checked", scan.orientation_checked},
                            {"confidence", scan.orientation_confidence},
                            {"doubtful_points", scan.doubtful_points},
                            {"components", scan.pieces}};
    entry["openings"] = openings(scan);
    entry["slides"] = slides(scan.slides);
    entry["notes"] = scan.notes;
    entry["warnings"] = scan.warnings;
    entry["spacing_m"] = scan.spacing_m;
    json[scan.name] = scan.error.empty() ? entry : Json{{"error", scan.error}};
  }
  return json;
}

}  // namespace

std::string to_json(const Result& result) {
  if (result.options.scans_only) {
    const Json json = {
        {"quick", result.options.quick}, {"seed", result.options.seed}, {"scans", scans(result)}};
    return json.dump(2) + "\n";
  }
  Json shapes = Json::object();
  for (const ShapeResult& shape : result.shapes) {
    for (const Mode mode : {kSurface, kPaper}) {
      shapes[shape.name][kModeNames[mode]] = scores_json(shape.modes[mode]);
    }
  }
  Json targets = Json::array();
  for (const Target& target : result.targets) {
    targets.push_back({{"name", target.name},
                       {"value", number(target.value)},
                       {"low", target.low},
                       {"high", target.high},
                       {"met", target.met()}});
  }
  const Json json = {{"quick", result.options.quick},
                     {"seed", result.options.seed},
                     {"tables", tables(result)},
                     {"shapes", shapes},
                     {"creases", creases(result.creases)},
                     {"stairs", creases(result.stairs)},
                     {"corners", creases(result.corners)},
                     {"unions", creases(result.unions)},
                     {"inside", inside(result)},
                     {"loop", loop(result.loop)},
                     {"scans", scans(result)},
                     {"targets", targets},
                     {"targets_met", result.all_met()}};
  return json.dump(2) + "\n";
}

}  // namespace tactree::evaluation
