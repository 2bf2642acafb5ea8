#include "tactree/simulation/hand_script.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "relief.hpp"

namespace tactree::simulation {
namespace {

constexpr double kSampleS = 0.002;    // between two waypoints
constexpr double kRubSpeed = 0.1;     // m/s at the centre of a stroke
constexpr double kClimbSpeed = 0.25;  // m/s: upwards along a relief
constexpr double kSinkSpeed = 0.1;    // m/s: downwards, including touchdown
constexpr double kRubDepth = 0.004;   // m: target depth below the surface
constexpr double kTraceDepth = 0.0015;
constexpr double kPressDepth = 0.008;
constexpr double kTau = 2.0 * std::numbers::pi;

/// Position of the hand over the relief at a time, and its depth below the surface.
struct Stroke {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double depth_m = 0.0;
};
using Motion = std::function<Stroke(double t_s)>;

double clearance(const Relief& relief) {
  return std::max(0.01, 0.05 * (relief.high() - relief.low()).maxCoeff());
}

/// Angular frequency of a stroke of this amplitude, at most 1.5 Hz and kRubSpeed: within the
/// abilities of a hand.
double stroke_rate(double amplitude_m) {
  return std::min(kTau * 1.5, kRubSpeed / std::max(amplitude_m, 1e-6));
}

/// Moving average over a tenth of a second, which smooths the steps between the relief's cells.
std::vector<double> smoothed(const std::vector<double>& values) {
  constexpr std::size_t kHalf = 25;
  std::vector<double> result;
  result.reserve(values.size());
  double sum = 0.0;
  std::size_t begin = 0;
  std::size_t end = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (; end < std::min(values.size(), i + kHalf + 1); ++end) {
      sum += values[end];
    }
    for (; begin + kHalf < i; ++begin) {
      sum -= values[begin];
    }
    result.push_back(sum / static_cast<double>(end - begin));
  }
  return result;
}

/// Path that starts above the relief, descends to it, follows the motion, and lifts off at the end.
HandPath follow(const Relief& relief, double seconds, const Motion& motion) {
  const double above = relief.high().z() + clearance(relief);
  const double lift_at = seconds - std::min(0.5, 0.2 * seconds);
  std::vector<Eigen::Vector2d> places;
  std::vector<double> heights;
  double w = above;
  double surface = above;
  const auto count = static_cast<std::size_t>(std::ceil(seconds / kSampleS)) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * kSampleS;
    const Stroke stroke = motion(t);
    // Over a hole `surface` and thereby the hand keep their heights.
    (void)relief.height(stroke.place.x(), stroke.place.y(), surface);
    const double wanted = t < lift_at ? surface - stroke.depth_m : above;
    w += std::clamp(wanted - w, -kSinkSpeed * kSampleS, kClimbSpeed * kSampleS);
    places.push_back(stroke.place);
    heights.push_back(w);
  }
  const std::vector<double> heights_smoothed = smoothed(heights);
  std::vector<Waypoint> waypoints;
  for (std::size_t i = 0; i < count; ++i) {
    waypoints.push_back({static_cast<double>(i) * kSampleS,
                         relief.to_model({places[i].x(), places[i].y(), heights_smoothed[i]})});
  }
  return HandPath(std::move(waypoints));
}

HandPath rub(const Relief& relief, double seconds) {
  const Eigen::Vector2d extent = (relief.high() - relief.low()).head<2>();
  const Eigen::Vector2d amplitude = 0.25 * extent;
  const double rate = stroke_rate(amplitude.maxCoeff());
  // The motion along the short side is slower by an irrational ratio, half the golden section: the
  // path does not repeat itself and covers its whole rectangle.
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0) * 0.5;
  const bool along_u = extent.x() >= extent.y();
  const double rate_u = along_u ? rate : ratio * rate;
  const double rate_v = along_u ? ratio * rate : rate;
  return follow(relief, seconds, [=, &relief](double t) {
    return Stroke{relief.middle() + Eigen::Vector2d(amplitude.x() * std::sin(rate_u * t),
                                                    amplitude.y() * std::sin(rate_v * t)),
                  kRubDepth};
  });
}

HandPath press(const Relief& relief, double seconds) {
  return follow(relief, seconds, [&relief](double t) {
    return Stroke{relief.middle(), 0.5 * kPressDepth * (1.0 - std::cos(kTau * 0.5 * t))};
  });
}

HandPath trace(const Relief& relief, double seconds) {
  const double radius = 0.2 * (relief.high() - relief.low()).head<2>().minCoeff();
  const double rate = 0.5 * stroke_rate(radius);
  return follow(relief, seconds, [=, &relief](double t) {
    return Stroke{
        relief.middle() + radius * Eigen::Vector2d(std::cos(rate * t), std::sin(rate * t)),
        kTraceDepth};
  });
}

HandPath hover(const Relief& relief, double seconds) {
  const Eigen::Vector2d amplitude = 0.35 * (relief.high() - relief.low()).head<2>();
  const double rate = stroke_rate(amplitude.maxCoeff());
  const double above = relief.high().z() + clearance(relief);
  std::vector<Waypoint> waypoints;
  const auto count = static_cast<std::size_t>(std::ceil(seconds / kSampleS)) + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) * kSampleS;
    const Eigen::Vector2d place =
        relief.middle() + Eigen::Vector2d(amplitude.x() * std::sin(rate * t),
                                          amplitude.y() * std::sin(2.0 * rate * t));
    waypoints.push_back({t, relief.to_model({place.x(), place.y(), above})});
  }
  return HandPath(std::move(waypoints));
}

}  // namespace

const std::vector<std::string>& script_names() {
  static const std::vector<std::string> kNames = {"rub", "press", "trace", "hover"};
  return kNames;
}

HandPath make_script(const std::string& name, const core::BlobView& view, double seconds) {
  const Relief relief(view);
  if (name == "rub") {
    return rub(relief, seconds);
  }
  if (name == "press") {
    return press(relief, seconds);
  }
  if (name == "trace") {
    return trace(relief, seconds);
  }
  if (name == "hover") {
    return hover(relief, seconds);
  }
  throw std::invalid_argument("unknown script '" + name + "'");
}

}  // namespace tactree::simulation
