#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "measurements.hpp"
#include "tactree/evaluation/creases.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;
using Distance = std::function<double(const Vector3d&)>;  // m, positive outside

constexpr double kReach = 0.012;  // m, half width of the cube around the origin with the starts
constexpr double kPath = 0.06;    // m, length of the path out of a body
constexpr double kAfter = 1e-3;   // m of the path outside the body on which the force must be zero
constexpr double kDeep = 30e-6;   // m; a start that is less deep may count as outside
constexpr double kToEnd = 0.1;    // maximum cosine between a path and the axis of a prism
constexpr int kRestTicks = 12;    // before the hand moves; it must be reported as inside by then
constexpr int kStayTicks = 50;    // after the return, because contact with a fast hand may be late
constexpr double kRates[] = {1000.0, 2000.0, 4000.0};
constexpr double kSpeeds[] = {0.1, 0.8};  // m/s

Vector3d in_cube(std::mt19937_64& random, double half) {
  std::uniform_real_distribution<double> place(-half, half);
  const double x = place(random);
  const double y = place(random);
  return {x, y, place(random)};
}

/// Moves a hand out of the body on a straight line, and back to its start.
void leave(const core::BlobView& view, const Distance& distance, const Vector3d& from,
           const Vector3d& way, double rate_hz, double speed, InsideResult& row) {
  Touch touch(view, core::RenderMode::kSurface, from, {}, rate_hz);
  Touched touched;
  for (int i = 0; i < kRestTicks; ++i) {
    touched = touch.to(from);
    row.force_N = std::max(row.force_N, touched.force.norm());
  }
  ++row.starts;
  row.shown += touched.inside ? 1 : 0;
  const double step = speed / rate_hz;
  const auto ticks = static_cast<int>(kPath / step);
  double outside = 0.0;
  for (int i = 1; i <= ticks; ++i) {
    touched = touch.to(from + i * step * way);
    outside += distance(from + i * step * way) > 0.0 ? step : 0.0;
    if (outside < kAfter) {
      row.force_N = std::max(row.force_N, touched.force.norm());
    }
  }
  bool felt = false;
  for (int i = ticks; i >= -kStayTicks; --i) {
    felt = touch.to(from + std::max(i, 0) * step * way).in_contact || felt;
  }
  row.felt += felt ? 1 : 0;
}

/// `open` is the axis of a prism, whose ends are open, or 0 for a body without open ends.
InsideResult measure(const std::string& name, const Shape& shape, const Distance& distance,
                     const Vector3d& open, int starts, std::mt19937_64& random) {
  InsideResult row;
  row.name = name;
  while (row.starts < starts) {
    const Vector3d from = in_cube(random, kReach);
    const Vector3d way = in_cube(random, 1.0).normalized();
    const bool leaves = std::abs(way.dot(open)) < kToEnd && distance(from + kPath * way) > kAfter;
    if (distance(from) < -kDeep && leaves) {
      leave(shape.view(), distance, from, way, kRates[row.starts % 3], kSpeeds[row.starts % 2],
            row);
    }
  }
  return row;
}

}  // namespace

std::vector<InsideResult> measure_inside(bool quick, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  const int starts = quick ? 60 : 600;
  std::vector<InsideResult> rows;
  const double radius = 0.012;
  rows.push_back(measure(
      "ball", sphere(radius), [&](const Vector3d& p) { return p.norm() - radius; },
      Vector3d::Zero(), starts, random));
  rows.push_back(measure(
      "cube", box(radius, 0.3, seed),
      [&](const Vector3d& p) { return p.cwiseAbs().maxCoeff() - radius; }, Vector3d::Zero(), starts,
      random));
  Prism wedge = ridge(30.0);
  wedge.turn = any_turn(random);
  rows.push_back(measure(
      "ridge of 30 degrees", sampled(wedge, 0.5e-3, 0.3, 0.0, seed),
      [&](const Vector3d& p) { return wedge.distance(p); }, wedge.turn.col(1), starts, random));
  const double half = 0.25 * kSpacing;
  rows.push_back(measure(
      "plate, h / 2 thick", plate(2.0 * half, 0.08),
      [&](const Vector3d& p) { return std::abs(p.z()) - half; }, Vector3d::Zero(), starts, random));
  return rows;
}

}  // namespace tactree::evaluation
