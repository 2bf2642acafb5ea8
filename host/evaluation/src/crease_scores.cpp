#include <fmt/format.h>

#include <cmath>
#include <random>
#include <utility>

#include "edge_path.hpp"
#include "measurements.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector3d;

constexpr double kBeyond = 4e-3;        // m, depth of the hand below the bottom of a concave crease
constexpr double kBelow = 0.6e-3;       // m, depth of the hand below the top of a ridge
constexpr double kStart = 6e-3;         // m, height above the crease at which the hand starts
constexpr double kAlongCrease = 10e-3;  // m, slide along the crease to both sides of the centre

/// Presses into a concave crease, rests, slides along the crease, to the side and back, and leaves.
EdgePath into(const Pace& pace) {
  EdgePath hand({0.3e-3, -kAlongCrease, kStart}, pace);
  hand.move_to({0.3e-3, -kAlongCrease, -kBeyond});
  hand.stay();
  hand.move_to({0.3e-3, kAlongCrease, -kBeyond});
  hand.move_to({1.5e-3, kAlongCrease, -0.7 * kBeyond});
  hand.move_to({-1e-3, -kAlongCrease, -0.7 * kBeyond});
  hand.move_to({0.0, -kAlongCrease, kStart});
  return hand;
}

/// Slides along a ridge, then across it.
EdgePath over(const Pace& pace) {
  EdgePath hand({-0.1e-3, -kAlongCrease, kStart}, pace);
  hand.move_to({-0.1e-3, -kAlongCrease, -kBelow});
  hand.move_to({-0.1e-3, kAlongCrease, -kBelow});
  hand.move_to({6e-3, kAlongCrease, -kBelow});
  return hand;
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
    row.rests = concave;
    row.noisy = noise > 0.0;
    for (int turns = 0; turns < crease_turns(quick); ++turns) {
      Prism prism = upright;
      if (turns != 0) {
        prism.turn = any_turn(random);
      }
      const Shape shape = sampled(prism, spacing, 0.3, noise, seed + static_cast<unsigned>(turns));
      const EdgeScene around{{shape.view()},
                             prism.turn,
                             [&](const Vector3d& p) { return prism.distance(prism.turn * p); },
                             off_line};
      for (const Pace& pace : paces(quick)) {
        follow(concave ? into(pace) : over(pace), around, row);
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
