#include "sampling/ball_bound.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "geometry/z_order.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

std::uint32_t count_in_ball(const std::vector<Eigen::Vector3d>& positions,
                            const Eigen::Vector3d& centre, double radius) {
  std::uint32_t count = 0;
  for (const Eigen::Vector3d& p : positions) {
    count += (p - centre).norm() <= radius ? 1U : 0U;
  }
  return count;
}

// The fullest of many balls, centred at points and between them.
std::uint32_t sampled_maximum(const std::vector<Eigen::Vector3d>& positions, double radius) {
  std::uint32_t most = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    most = std::max(most, count_in_ball(positions, positions[i], radius));
    const Eigen::Vector3d offset(unit_random(3 * i) - 0.5, unit_random(3 * i + 1) - 0.5,
                                 unit_random(3 * i + 2) - 0.5);
    most = std::max(most, count_in_ball(positions, positions[i] + radius * offset, radius));
  }
  return most;
}

void expect_tight(const std::vector<Eigen::Vector3d>& positions, double radius) {
  const std::uint32_t bound = max_points_in_ball(positions, radius);
  const std::uint32_t sampled = sampled_maximum(positions, radius);
  EXPECT_GE(bound, sampled);
  EXPECT_LE(bound, 1.25 * sampled + 1.0);
}

TEST(BallBound, IsTightOnSurfaces) {
  expect_tight(plane_grid(50, 1.0).positions, 3.0);
  expect_tight(cosine_sheet(60, 0.06, 0.005, 300.0).positions, 0.003);
  expect_tight(random_sphere(3000, 0.03).positions, 0.006);
}

TEST(BallBound, IsTightInClumpedVolume) {
  std::vector<Eigen::Vector3d> volume;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    volume.emplace_back(unit_random(3 * i), unit_random(3 * i + 1), unit_random(3 * i + 2));
  }
  expect_tight(volume, 0.15);
  for (std::uint64_t i = 0; i < 500; ++i) {  // far denser than the rest
    volume.emplace_back(2.0 + 0.01 * unit_random(i), 0.5, 0.5);
  }
  expect_tight(volume, 0.15);
}

TEST(BallBound, CoversBallsCentredBetweenPoints) {
  // A ball around the middle of a cube just contains its corners; a ball around a corner only one.
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(max_points_in_ball(cube.positions, 0.5 * std::sqrt(3.0)), 8U);
  EXPECT_LT(max_points_in_ball(cube.positions, 0.45), 3U);
}

TEST(BallBound, HandlesTrivialCases) {
  EXPECT_EQ(max_points_in_ball({}, 1.0), 0U);
  EXPECT_EQ(max_points_in_ball(std::vector<Eigen::Vector3d>(7, Eigen::Vector3d(1, 2, 3)), 0.1), 7U);
}

TEST(BallBound, IsIndependentOfThreads) {
  const Cloud cloud = random_sphere(4000, 0.03, 7);
  std::vector<std::uint64_t> rank(cloud.size());
  for (std::size_t i = 0; i < rank.size(); ++i) {
    rank[i] = hash64(i);
  }
  std::uint32_t bounds[2];
  std::vector<bool> kept[2];
  for (std::size_t threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    bounds[threads - 1] = max_points_in_ball(cloud.positions, 0.005);
    kept[threads - 1] = thin_to_ball_bound(cloud.positions, rank, 0.005, 20);
  }
  EXPECT_EQ(bounds[0], bounds[1]);
  EXPECT_EQ(kept[0], kept[1]);
}

TEST(BallBound, ThinsOnlyOverfullBalls) {
  Cloud cloud = even_sphere(3000, 0.03);
  const std::size_t sparse = cloud.size();
  for (std::uint64_t i = 0; i < 400; ++i) {  // a clump at the pole
    cloud.positions.emplace_back(1e-3 * unit_random(2 * i), 1e-3 * unit_random(2 * i + 1), 0.03);
  }
  std::vector<std::uint64_t> rank(cloud.size());
  for (std::size_t i = 0; i < rank.size(); ++i) {
    rank[i] = hash64(i);
  }
  const double radius = 0.004;
  constexpr std::uint32_t kMax = 40;
  ASSERT_LT(max_points_in_ball(std::span(cloud.positions).first(sparse), radius), kMax);
  const std::vector<bool> kept = thin_to_ball_bound(cloud.positions, rank, radius, kMax);
  std::vector<Eigen::Vector3d> left;
  std::size_t dropped_far = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (kept[i]) {
      left.push_back(cloud.positions[i]);
    } else if ((cloud.positions[i] - Eigen::Vector3d(0, 0, 0.03)).norm() > 3.0 * radius) {
      ++dropped_far;
    }
  }
  EXPECT_EQ(dropped_far, 0U);
  EXPECT_LE(sampled_maximum(left, radius), kMax);
  EXPECT_GT(left.size(), cloud.size() - 420U);
}

}  // namespace
}  // namespace tactree::builder
