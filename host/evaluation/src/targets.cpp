#include <algorithm>
#include <cmath>
#include <limits>

#include "measurements.hpp"

namespace tactree::evaluation {
namespace {

class Checker {
 public:
  explicit Checker(const Result& result) : result_(result) {}

  void at_most(const std::string& shape, const std::string& score, double high,
               const std::string& unit) {
    targets_.push_back({shape + "." + score, get(shape, score), 0.0, high, unit});
  }
  void add(Target target) { targets_.push_back(std::move(target)); }
  [[nodiscard]] double get(const std::string& shape, const std::string& score) const {
    const auto found = std::find_if(result_.shapes.begin(), result_.shapes.end(),
                                    [&](const ShapeResult& s) { return s.name == shape; });
    return found == result_.shapes.end() ? std::nan("") : found->modes[kSurface].get(score);
  }
  [[nodiscard]] std::vector<Target> take() { return std::move(targets_); }

 private:
  const Result& result_;
  std::vector<Target> targets_;
};

double lowest_accuracy(const Result& result) {
  double lowest = 1.0;
  for (const DetectionRow& row : result.detection) {
    lowest =
        std::min({lowest, row.tracing[kSurface].accuracy(), row.hovering[kSurface].accuracy()});
  }
  return lowest;
}

/// Minimum and maximum ratio of the measured limits to the formula, and minimum gain by passivity
/// control with a hand.
void add_limits(const LoopResult& loop, Checker& check) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = 0.0;
  double gain = std::numeric_limits<double>::infinity();
  for (const LoopResult::Limit& c : loop.limits) {
    lowest = std::min(lowest, c.measured_N_m / c.formula_N_m);
    highest = std::max(highest, c.measured_N_m / c.formula_N_m);
    gain = c.hand_Ns_m > 0.0 ? std::min(gain, c.passive_N_m / c.measured_N_m) : gain;
  }
  check.add({"loop.stiffness over formula, min", lowest, 0.9, 1.1, ""});
  check.add({"loop.stiffness over formula, max", highest, 0.9, 1.1, ""});
  check.add({"loop.stiffness gained by passivity", gain, 1.7, 1e3, ""});
}

void add_creases(const std::string& name, const std::vector<CreaseResult>& creases,
                 Checker& check) {
  double lost = 0.0;
  double late = 0.0;
  double off = 0.0;
  double step = 0.0;
  for (const CreaseResult& row : creases) {
    lost += row.lost;
    late = std::max({late, row.late_m, row.fast_late_m});
    if (row.rests && !row.noisy) {
      off = std::max(off, row.off_m);
      step = std::max(step, row.step_N);
    }
  }
  check.add({name + ".contact_lost", lost, 0.0, 0.0, ""});
  check.add({name + ".noticed_at_m", late, 0.0, 1e-3, "m"});
  check.add({name + ".off_m", off, 0.0, 5e-6, "m"});
  check.add({name + ".step_N", step, 0.0, 0.1, "N"});
}

void add_inside(const std::vector<InsideResult>& inside, Checker& check) {
  double force = 0.0;
  int hidden = 0;
  int missed = 0;
  for (const InsideResult& row : inside) {
    force = std::max(force, row.force_N);
    hidden += row.starts - row.shown;
    missed += row.starts - row.felt;
  }
  check.add({"inside.force_N", force, 0.0, 0.0, "N"});
  check.add({"inside.not_shown", static_cast<double>(hidden), 0.0, 0.0, ""});
  check.add({"inside.not_felt_again", static_cast<double>(missed), 0.0, 0.0, ""});
}

}  // namespace

std::vector<Target> check_targets(const Result& result) {
  Checker check(result);
  check.add({"detection, all rows of Table 1", lowest_accuracy(result), 0.999, 1.0, ""});
  for (const char* shape : {"cos", "sphere"}) {
    check.at_most(shape, "distance_rms_m", 1.0e-6, "m");
    check.at_most(shape, "normal_rms_deg", 0.25, "deg");
  }
  check.at_most("box_edge", "distance_rms_m", 25e-6, "m");
  check.at_most("box_edge", "distance_max_m", 120e-6, "m");
  for (const char* shape :
       {"cos", "sphere", "box_face", "plate", "sheet", "cos_coarse", "sphere_coarse"}) {
    check.at_most(shape, "force_step_max_N", 0.005, "N");
  }
  for (const ShapeResult& shape : result.shapes) {
    if (!std::isnan(shape.modes[kSurface].get("crossings"))) {
      check.at_most(shape.name, "crossings_missed", 0.0, "");
    }
  }
  check.at_most("irregular", "contact_lost", 0.0, "");
  check.at_most("thinned", "contact_lost", 0.0, "");
  for (const char* flat : {"box_face", "plate", "sheet"}) {
    check.add(
        {std::string(flat) + ".friction_min", check.get(flat, "friction_min"), 0.295, 0.305, ""});
    check.add(
        {std::string(flat) + ".friction_max", check.get(flat, "friction_max"), 0.295, 0.305, ""});
  }
  check.at_most("cos", "friction_max", 0.32, "");
  check.at_most("sphere", "friction_max", 0.32, "");
  check.add({"loop.vibration_m_s2", result.loop.vibration_m_s2[kSurface], 0.0, 0.06, "m/s2"});
  add_creases("creases", result.creases, check);
  add_creases("stairs", result.stairs, check);
  add_creases("corners", result.corners, check);
  add_creases("unions", result.unions, check);
  add_inside(result.inside, check);
  add_limits(result.loop, check);
  return check.take();
}

}  // namespace tactree::evaluation
