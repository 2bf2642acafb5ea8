#include "sampling/resample.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

bool same_side(const ZOrderedCloud& points, std::uint32_t a, std::uint32_t b) {
  return !points.cloud().has_normals() || points.normals()[a].isZero() ||
         points.normals()[b].isZero() ||
         points.normals()[a].dot(points.normals()[b]) > kSameSideCosine;
}

void expect_maximal_packing(const ZOrderedCloud& points, double distance) {
  const std::vector<std::uint32_t> kept = select_poisson_disk(points, distance);
  std::vector<bool> is_kept(points.size(), false);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    ASSERT_TRUE(k == 0 || kept[k] > kept[k - 1]);
    is_kept[kept[k]] = true;
  }
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    bool beaten = false;
    points.visit_within(points.positions()[i], distance, [&](std::uint32_t j, double squared) {
      beaten = beaten ||
               (j != i && is_kept[j] && squared < distance * distance && same_side(points, i, j));
    });
    ASSERT_NE(beaten, static_cast<bool>(is_kept[i])) << "point " << i;
  }
}

TEST(Resample, KeepsDistanceWithoutGaps) {
  expect_maximal_packing(ZOrderedCloud(random_sphere(20000, 1.0)), 0.05);
  expect_maximal_packing(ZOrderedCloud(without_normals(random_sphere(20000, 1.0))), 0.05);
  expect_maximal_packing(ZOrderedCloud(without_normals(random_sphere(5000, 1.0))), 0.9);
  expect_maximal_packing(ZOrderedCloud(random_sphere(5000, 1.0)), 1e-9);
  expect_maximal_packing(ZOrderedCloud(random_sphere(500, 1.0)), 10.0);
}

TEST(Resample, UnknownNormalsCompeteWithAll) {
  Cloud cloud = random_sphere(8000, 1.0);
  for (std::size_t i = 0; i < cloud.size(); i += 3) {
    cloud.normals[i].setZero();
  }
  expect_maximal_packing(ZOrderedCloud(std::move(cloud)), 0.08);
}

TEST(Resample, GivesOnePointPerSquare) {
  const std::size_t n = 300000;
  const ZOrderedCloud points(random_sphere(n, 1.0));
  const double spacing = 0.04;  // 38 candidates a square
  const std::size_t kept = select_poisson_disk(points, kDistanceOverSpacing * spacing).size();
  const double per_square =
      static_cast<double>(kept) * spacing * spacing / (4.0 * std::numbers::pi);
  EXPECT_GT(per_square, 0.9);
  EXPECT_LT(per_square, 1.0);
}

TEST(Resample, KeepsGridOfSameSpacing) {
  const ZOrderedCloud points(plane_grid(80, 0.001));
  EXPECT_EQ(select_poisson_disk(points, kDistanceOverSpacing * 0.001).size(), points.size());
  EXPECT_LT(select_poisson_disk(points, 1.001 * 0.001).size(), points.size());
}

TEST(Resample, KeepsBothPlateSides) {
  Cloud plate;
  for (const double side : {1.0, -1.0}) {
    for (const Eigen::Vector3d& p : cosine_sheet(100, 0.1, 0.0, 1.0).positions) {
      plate.positions.push_back(p + Eigen::Vector3d(0, 0, side * 1e-4));
      plate.normals.emplace_back(0.0F, 0.0F, static_cast<float>(side));
    }
  }
  const ZOrderedCloud points(std::move(plate));
  std::size_t up = 0;
  const std::vector<std::uint32_t> kept = select_poisson_disk(points, 0.002);
  for (const std::uint32_t i : kept) {
    up += points.normals()[i].z() > 0.0F ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(up), 0.5 * static_cast<double>(kept.size()),
              0.05 * static_cast<double>(kept.size()));
  EXPECT_GT(kept.size(), 2U * 1500U);
}

TEST(Resample, IsIndependentOfThreads) {
  const ZOrderedCloud points(random_sphere(50000, 1.0, 3));
  std::vector<std::uint32_t> kept[2];
  for (std::size_t threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    kept[threads - 1] = select_poisson_disk(points, 0.02);
  }
  EXPECT_EQ(kept[0], kept[1]);
}

}  // namespace
}  // namespace tactree::builder
