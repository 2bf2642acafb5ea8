#include "geometry/spacing.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

TEST(Spacing, EqualsGridEdge) {
  const SpacingEstimate estimate = estimate_spacing(ZOrderedCloud(plane_grid(100, 0.002)));
  EXPECT_NEAR(estimate.median_m, 0.002, 0.05 * 0.002);
  EXPECT_NEAR(estimate.mean_m, 0.002, 0.08 * 0.002);  // the border's points have half a disc
}

TEST(Spacing, EqualsRootOfPointArea) {
  for (const std::size_t n : {3000U, 100000U}) {
    const double expected = std::sqrt(4.0 * std::numbers::pi / static_cast<double>(n));
    for (const Cloud& cloud : {even_sphere(n, 1.0), random_sphere(n, 1.0)}) {
      const SpacingEstimate estimate = estimate_spacing(ZOrderedCloud(cloud));
      EXPECT_NEAR(estimate.median_m, expected, 0.06 * expected);
      EXPECT_NEAR(estimate.mean_m, expected, 0.06 * expected);
    }
  }
}

TEST(Spacing, TellsEvenFromIndependentPoints) {
  const auto unevenness = [](Cloud cloud) {
    return estimate_spacing(ZOrderedCloud(std::move(cloud))).unevenness;
  };
  EXPECT_NEAR(unevenness(plane_grid(100, 0.002)), 1.0, 0.01);
  EXPECT_LT(unevenness(even_sphere(20000, 1.0)), 1.1);
  EXPECT_GT(unevenness(random_sphere(20000, 1.0)), 1.35);
  EXPECT_EQ(unevenness({}), 1.0);
}

TEST(Spacing, MeanIncludesSparserParts) {
  Cloud cloud = plane_grid(60, 0.001);  // half the points on a hundredth of the area
  for (Eigen::Vector3d p : plane_grid(60, 0.01).positions) {
    p.z() = 1.0;
    cloud.positions.push_back(p);
  }
  const SpacingEstimate estimate = estimate_spacing(ZOrderedCloud(std::move(cloud)));
  EXPECT_NEAR(estimate.mean_m, 0.01 / std::sqrt(2.0), 0.1 * 0.01);
}

TEST(Spacing, EqualsDistanceOfFewPoints) {
  EXPECT_NEAR(
      estimate_spacing(ZOrderedCloud({box_mesh({0, 0, 0}, {2, 2, 2}).positions, {}, {}})).median_m,
      2.0, 1e-9);
  EXPECT_EQ(estimate_spacing(ZOrderedCloud()).median_m, 0.0);
}

}  // namespace
}  // namespace tactree::builder
