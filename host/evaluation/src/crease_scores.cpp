#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "measurements.hpp"
#include "tactree/evaluation/creases.hpp"
#include "touch.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kBeyond = 4e-3;    // m, depth of the hand below the bottom of a concave crease
constexpr double kBelow = 0.6e-3;   // m, depth of the hand below the top of a ridge
constexpr double kStart = 6e-3;     // m, height above the crease at which the hand starts
constexpr double kAlong = 10e-3;    // m, slide along the crease to both sides of the centre
constexpr double kStayS = 0.1;      // rest, after which the proxy must be on the crease
constexpr double kNoticed = 20e-6;  // m, an encoder count; contact is not required above this depth

struct Pace {
  double rate_hz;
  double speed_m_s;
};
constexpr Pace kPaces[] = {
    {1000.0, 0.02}, {1000.0, 0.1}, {2000.0, 0.1}, {4000.0, 0.1}, {4000.0, 0.5}};
constexpr double kFast = 0.2;  // m/s; a hand that is faster has a separate score

/// Positions of the hand, one per tick, in the frame of the crease, m.
using Hand = std::vector<Vector3d>;

void move_to(Hand& hand, const Vector3d& end, double step) {
  const Vector3d begin = hand.back();
  const auto ticks = std::max(1L, std::lround((end - begin).norm() / step));
  for (long i = 1; i <= ticks; ++i) {
    hand.emplace_back(begin + (static_cast<double>(i) / double(ticks)) * (end - begin));
  }
}

/// Presses into a concave crease, rests, slides along the crease, to the side and back, and leaves.
Hand into(double step, double rate_hz) {
  Hand hand{{0.3e-3, -kAlong, kStart}};
  move_to(hand, {0.3e-3, -kAlong, -kBeyond}, step);
  for (double stay = 0.0; stay < kStayS * rate_hz; stay += 1.0) {
    hand.push_back(hand.back());
  }
  move_to(hand, {0.3e-3, kAlong, -kBeyond}, step);
  move_to(hand, {1.5e-3, kAlong, -0.7 * kBeyond}, step);
  move_to(hand, {-1e-3, -kAlong, -0.7 * kBeyond}, step);
  move_to(hand, {0.0, -kAlong, kStart}, step);
  return hand;
}

/// Slides along a ridge, then across it.
Hand over(double step, double) {
  Hand hand{{-0.1e-3, -kAlong, kStart}};
  move_to(hand, {-0.1e-3, -kAlong, -kBelow}, step);
  move_to(hand, {-0.1e-3, kAlong, -kBelow}, step);
  move_to(hand, {6e-3, kAlong, -kBelow}, step);
  return hand;
}

void score(const core::BlobView& view, const Hand& hand, const Eigen::Matrix3d& turn,
           const std::function<double(const Vector3d&)>& distance,
           const std::function<double(const Vector3d&)>& off_crease, const Pace& pace,
           CreaseResult& row) {
  const double rate_hz = pace.rate_hz;
  const bool is_fast = pace.speed_m_s > kFast;
  Touch touch(view, core::RenderMode::kSurface, turn * hand.front(), {}, rate_hz);
  Vector3d last = Vector3d::Zero();
  bool felt = false;
  double stays_s = 0.0;
  for (std::size_t i = 0; i < hand.size(); ++i) {
    const Vector3d probe = turn * hand[i];
    const Touched touched = touch.to(probe);
    const double depth = -distance(probe);
    const double travel = i == 0 ? 0.0 : (hand[i] - hand[i - 1]).norm();
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
    stays_s = i != 0 && travel == 0.0 ? stays_s + 1.0 / rate_hz : 0.0;
    if (stays_s > 0.9 * kStayS) {
      row.off_m = std::max(row.off_m, off_crease(turn.transpose() * touched.proxy));
    }
    last = touched.force;
  }
}

double off_line(const Vector3d& p) { return std::hypot(p.x(), p.z()); }

}  // namespace

std::vector<CreaseResult> measure_creases(bool quick, std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::vector<CreaseResult> rows;
  const auto measure = [&](const std::string& name, const Prism& upright, bool concave,
                           double spacing, double noise) {
    CreaseResult row;
    row.name = name;
    row.concave = concave;
    row.noisy = noise > 0.0;
    for (int turns = 0; turns < (quick ? 2 : 4); ++turns) {
      Prism prism = upright;
      if (turns != 0) {
        prism.turn = any_turn(random);
      }
      const Shape shape = sampled(prism, spacing, 0.3, noise, seed + static_cast<unsigned>(turns));
      for (const Pace& pace : kPaces) {
        const double step = pace.speed_m_s / pace.rate_hz;
        score(
            shape.view(), (concave ? into : over)(step, pace.rate_hz), prism.turn,
            [&](const Vector3d& p) { return prism.distance(p); }, off_line, pace, row);
      }
    }
    rows.push_back(std::move(row));
  };
  for (const double spacing : {0.5e-3, 1e-3}) {
    for (const double angle : {20.0, 30.0, 45.0, 60.0, 75.0, 90.0, 105.0, 120.0, 135.0, 150.0}) {
      measure(fmt::format("groove {:.0f}, h = {} mm", angle, 1e3 * spacing), groove(angle), true,
              spacing, 0.0);
    }
  }
  for (const double angle : {60.0, 90.0, 120.0}) {
    measure(fmt::format("groove {:.0f}, points off by 5 % of h", angle), groove(angle), true, 1e-3,
            0.05);
  }
  for (const double angle : {20.0, 30.0, 45.0, 60.0, 75.0, 90.0, 105.0, 120.0, 135.0, 150.0}) {
    measure(fmt::format("ridge {:.0f}, h = 0.5 mm", angle), ridge(angle), false, 0.5e-3, 0.0);
  }
  return rows;
}

}  // namespace tactree::evaluation
