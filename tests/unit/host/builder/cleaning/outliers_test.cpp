#include "cleaning/outliers.hpp"

#include <gtest/gtest.h>

#include "geometry/spacing.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

TEST(Outliers, PlausibleBoxIgnoresOutliers) {
  Cloud cloud = random_sphere(2000, 0.1);
  const Box clean = plausible_box(cloud.positions, 10.0);
  for (const double far : {1.0, 1e3, 1e5}) {
    Cloud strayed = cloud;
    for (int k = 0; k < 10; ++k) {
      strayed.positions.emplace_back(far * (k % 2 == 0 ? 1 : -1), far * k, -far);
    }
    const Box box = plausible_box(strayed.positions, 10.0);
    EXPECT_LT((box.min() - clean.min()).norm(), 0.05 * clean.sizes().norm());
    EXPECT_LT((box.max() - clean.max()).norm(), 0.05 * clean.sizes().norm());
    for (const Eigen::Vector3d& p : cloud.positions) {
      ASSERT_TRUE(box.contains(p));
    }
  }
}

TEST(Outliers, PlausibleBoxContainsFewPoints) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1});
  const Box box = plausible_box(cube.positions, 10.0);
  for (const Eigen::Vector3d& p : cube.positions) {
    EXPECT_TRUE(box.contains(p));
  }
  EXPECT_TRUE(plausible_box(std::span(cube.positions).first(3), 10.0).isEmpty());
}

TEST(Outliers, DropsIsolatedPointsNearScan) {
  Cloud cloud = even_sphere(5000, 0.1);
  const std::size_t n = cloud.size();
  cloud.positions.emplace_back(0.3, 0.0, 0.0);
  cloud.positions.emplace_back(0.0, -0.5, 0.1);
  cloud.positions.emplace_back(0.0, 0.0, 1.0);
  cloud.normals.resize(n + 3, Eigen::Vector3f::UnitX());
  const ZOrderedCloud points(std::move(cloud));
  const std::vector<std::uint32_t> kept =
      points_in_company(points, estimate_spacing(points).median_m);
  EXPECT_EQ(kept.size(), n);
  for (const std::uint32_t i : kept) {
    EXPECT_LT(points.positions()[i].norm(), 0.11);
  }
}

TEST(Outliers, KeepsSmallScanParts) {
  // A handle of 40 points beside a dense body, and a coarse distant wall.
  Cloud cloud = without_normals(even_sphere(20000, 0.1));
  for (int k = 0; k < 40; ++k) {
    cloud.positions.emplace_back(0.3 + 0.001 * k, 0.0, 0.0);
  }
  for (Eigen::Vector3d p : plane_grid(30, 0.05).positions) {
    p.z() = -1.0;
    cloud.positions.push_back(p);
  }
  const ZOrderedCloud points(std::move(cloud));
  EXPECT_EQ(points_in_company(points, estimate_spacing(points).median_m).size(), points.size());
}

TEST(Outliers, KeepsTinyInputs) {
  for (std::size_t n = 1; n <= 8; ++n) {
    Cloud cloud;
    cloud.positions = box_mesh({0, 0, 0}, {1, 1, 1}).positions;
    cloud.positions.resize(n);
    const ZOrderedCloud points(std::move(cloud));
    EXPECT_EQ(points_in_company(points, std::max(1e-3, estimate_spacing(points).median_m)).size(),
              n);
  }
}

}  // namespace
}  // namespace tactree::builder
