// The shortest move to the front of up to three planes, against a search among all sets of planes
// in double precision.

#include "tactree/core/contact/constraint_planes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tactree/plant/vectors.hpp"

namespace tactree::test {
namespace {

using Eigen::Vector3d;
using plant::narrow;
using plant::widen;

constexpr double kOn = 1e-6;  // m

struct Random {
  std::mt19937_64 engine{5};
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> unit{-1.0, 1.0};

  Vector3d direction() {
    const double x = any(engine);
    const double y = any(engine);
    return Vector3d(x, y, any(engine)).normalized();
  }
};

core::ConstraintPlanes planes_of(const std::vector<Vector3d>& normals,
                                 const std::vector<double>& distances) {
  core::ConstraintPlanes planes;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    planes.plane[i] = {narrow(normals[i]), static_cast<float>(distances[i])};
  }
  planes.count = static_cast<std::uint32_t>(normals.size());
  return planes;
}

/// The least distance to a place in front of all planes (and on the first one): the least of the
/// moves onto each set of planes that is allowed. Infinite: there is none.
double least_distance(const std::vector<Vector3d>& normals, const std::vector<double>& distances,
                      bool onto_first) {
  const std::size_t count = normals.size();
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = onto_first ? 1U : 0U; set < (1U << count); ++set) {
    if (onto_first && (set & 1U) == 0U) {
      continue;
    }
    std::vector<std::size_t> members;
    for (std::size_t i = 0; i < count; ++i) {
      if ((set >> i & 1U) != 0U) {
        members.push_back(i);
      }
    }
    const auto n = static_cast<Eigen::Index>(members.size());
    Eigen::MatrixXd rows(n, 3);
    Eigen::VectorXd values(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      rows.row(k) = normals[members[static_cast<std::size_t>(k)]].transpose();
      values[k] = -distances[members[static_cast<std::size_t>(k)]];
    }
    const Vector3d step =
        n == 0 ? Vector3d::Zero() : Vector3d(rows.completeOrthogonalDecomposition().solve(values));
    if (n != 0 && (rows * step - values).norm() > kOn) {
      continue;
    }
    bool allowed = true;
    for (std::size_t i = 0; i < count; ++i) {
      allowed = allowed && normals[i].dot(step) + distances[i] > -kOn;
    }
    least = allowed ? std::min(least, step.norm()) : least;
  }
  return least;
}

void expect_shortest(const std::vector<Vector3d>& normals, const std::vector<double>& distances,
                     bool onto_first) {
  const double truth = least_distance(normals, distances, onto_first);
  const core::PlaneMove move = core::shortest_move(planes_of(normals, distances), onto_first);
  const Vector3d step = widen(move.step);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const double left = normals[i].dot(step) + distances[i];
    ASSERT_GT(left, -2.0 * kOn);
    if ((move.active >> i & 1U) != 0U) {
      ASSERT_LT(std::abs(left), 2.0 * kOn);
    }
  }
  if (onto_first) {
    ASSERT_NE(move.active & 1U, 0U);
  }
  ASSERT_NEAR(step.norm(), truth, 1e-5 * truth + 2.0 * kOn);
}

TEST(ConstraintPlanes, FindsShortestMove) {
  Random random;
  int compared = 0;
  for (int i = 0; i < 60'000; ++i) {
    const auto count = static_cast<std::size_t>(1 + i % 3);
    std::vector<Vector3d> normals;
    std::vector<double> distances;
    for (std::size_t k = 0; k < count; ++k) {
      normals.push_back(random.direction());
      distances.push_back(2e-3 * random.unit(random.engine));
    }
    // Nearly parallel planes, or three that nearly meet in a line, have no useful answer.
    bool good = true;
    for (std::size_t k = 0; k < count; ++k) {
      good = good && std::abs(normals[k].dot(normals[(k + 1) % count])) < (count > 1 ? 0.98 : 2.0);
    }
    good = good && (count < 3 || std::abs(normals[0].dot(normals[1].cross(normals[2]))) > 0.05);
    for (const bool onto_first : {false, true}) {
      if (good && least_distance(normals, distances, onto_first) < 1.0) {
        expect_shortest(normals, distances, onto_first);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 80'000);
}

TEST(ConstraintPlanes, KeepsUnconstrainedPoint) {
  const core::PlaneMove move = core::shortest_move(
      planes_of({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}, {1e-3, 0.0, 2e-3}),
      false);
  EXPECT_EQ(move.active, 0U);
  EXPECT_EQ(move.step, core::Vec3{});
}

TEST(ConstraintPlanes, HoldsCornerWithThreePlanes) {
  const core::PlaneMove move = core::shortest_move(
      planes_of({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}, {-1e-3, -2e-3, -3e-3}),
      false);
  EXPECT_EQ(move.active, 7U);
  EXPECT_LT((widen(move.step) - Vector3d(1e-3, 2e-3, 3e-3)).norm(), 1e-9);
}

TEST(ConstraintPlanes, ResolvesContradictionByWorstPlane) {
  // Two walls that face each other with a negative gap.
  const core::PlaneMove move = core::shortest_move(
      planes_of({Vector3d::UnitX(), -Vector3d::UnitX()}, {-1e-3, -3e-3}), false);
  EXPECT_EQ(move.active, 2U);
  EXPECT_LT((widen(move.step) - Vector3d(-3e-3, 0.0, 0.0)).norm(), 1e-9);
}

TEST(ConstraintPlanes, IgnoresUnusedPlanes) {
  core::ConstraintPlanes planes = planes_of({Vector3d::UnitZ()}, {-1e-3});
  planes.step_by({1.0F, 1.0F, 0.5e-3F});
  EXPECT_LT((widen(core::shortest_move(planes, false).step) - Vector3d(0.0, 0.0, 0.5e-3)).norm(),
            1e-9);
}

}  // namespace
}  // namespace tactree::test
