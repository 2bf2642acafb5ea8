#include "edge_path.hpp"

#include <algorithm>
#include <cmath>

#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kStayS = 0.1;
constexpr double kNoticed = 20e-6;  // m, an encoder count; contact is not required above this depth
constexpr double kFast = 0.2;       // m/s; a hand that is faster has a separate score

}  // namespace

void EdgePath::move_to(const Vector3d& end) {
  const Vector3d begin = places_.back();
  const double step = pace_.speed_m_s / pace_.rate_hz;
  const auto ticks = std::max(1L, std::lround((end - begin).norm() / step));
  for (long i = 1; i <= ticks; ++i) {
    places_.emplace_back(begin + (static_cast<double>(i) / double(ticks)) * (end - begin));
  }
}

void EdgePath::stay() {
  const auto ticks = static_cast<std::size_t>(std::lround(kStayS * pace_.rate_hz));
  places_.insert(places_.end(), ticks, Vector3d(places_.back()));
}

void follow(const EdgePath& path, const EdgeScene& around, CreaseResult& row) {
  const double rate_hz = path.pace().rate_hz;
  const bool is_fast = path.pace().speed_m_s > kFast;
  Touch touch(around.bodies, core::RenderMode::kSurface, around.turn * path.places().front(), {},
              rate_hz);
  Vector3d last = Vector3d::Zero();
  Vector3d before = path.places().front();
  bool felt = false;
  double stays_s = 0.0;
  for (const Vector3d& hand : path.places()) {
    const Touched touched = touch.to(around.turn * hand);
    const double depth = -around.distance(hand);
    const double travel = (hand - before).norm();
    ++row.ticks;
    if (depth > kNoticed && !touched.in_contact) {
      row.lost += felt ? 1 : 0;
      double& late_m = is_fast ? row.fast_late_m : row.late_m;
      late_m = felt ? late_m : std::max(late_m, depth);
    }
    const bool was_felt = felt;
    felt = (felt && depth > 0.0) || touched.in_contact;
    if (was_felt && touched.in_contact && !is_fast) {
      row.step_N = std::max(row.step_N, (touched.force - last).norm() - kStiffness_N_m * travel);
    }
    stays_s = travel == 0.0 ? stays_s + 1.0 / rate_hz : 0.0;
    if (stays_s > 0.9 * kStayS) {
      row.off_m = std::max(row.off_m, around.off(around.turn.transpose() * touched.proxy));
    }
    last = touched.force;
    before = hand;
  }
}

}  // namespace tactree::evaluation
