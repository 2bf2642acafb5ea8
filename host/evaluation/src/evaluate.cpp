#include <algorithm>

#include "errors.hpp"
#include "measurements.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

double Scores::get(const std::string& name) const {
  const auto found = std::find_if(values_.begin(), values_.end(),
                                  [&](const auto& value) { return value.first == name; });
  return found == values_.end() ? kNotMeasured : found->second;
}

bool Result::all_met() const {
  return std::all_of(targets.begin(), targets.end(), [](const Target& t) { return t.met(); });
}

namespace {

// Lines have about 540 ticks, 0.1 mm each; 64 of them give more than 30 000 ticks in which contact
// may be lost.
constexpr int kLines = 64;

void evaluate_shapes(const Options& options, builder::Progress& progress, Result& result) {
  const Effort effort = options.quick ? Effort{2000, 50, 10} : Effort{};
  const std::vector<Subject> subjects = make_subjects(options.seed, options.quick ? 16 : kLines);
  for (const Subject& subject : subjects) {
    progress.begin("shape: " + subject.title);
    ShapeResult shape{subject.name, subject.title, {}};
    for (const Mode mode : {kSurface, kPaper}) {
      shape.modes[mode] = score_shape(subject, mode, effort, options.seed);
    }
    result.shapes.push_back(std::move(shape));
    if (subject.name == "cos_coarse") {
      result.trace = trace_force(subject);
    }
  }
}

void evaluate_scans(const Options& options, builder::Progress& progress, Result& result) {
  for (const std::filesystem::path& scan : options.scans) {
    progress.begin("scan: " + scan.filename().string());
    result.scans.push_back(score_scan(scan, options));
  }
}

}  // namespace

Result evaluate(const Options& options, builder::Progress& progress) {
  Result result;
  result.options = options;
  if (options.scans_only) {
    evaluate_scans(options, progress, result);
    progress.end();
    return result;
  }
  progress.begin("the paper's Table 1");
  result.detection = measure_detection(options.seed);
  progress.begin("the paper's Table 2");
  result.distances = measure_distances(options.seed, options.quick ? 300 : 3000);
  evaluate_shapes(options, progress, result);
  progress.begin("creases");
  result.creases = measure_creases(options.quick, options.seed);
  progress.begin("stairs, rooms and bodies together");
  measure_courses(options.quick, options.seed, result);
  progress.begin("starts inside");
  result.inside = measure_inside(options.quick, options.seed);
  progress.begin("the closed loop");
  result.loop = measure_loop(options.quick);
  evaluate_scans(options, progress, result);
  progress.end();
  result.targets = check_targets(result);
  return result;
}

}  // namespace tactree::evaluation
