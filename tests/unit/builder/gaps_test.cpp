#include "gaps.hpp"

#include <gtest/gtest.h>

#include "resample.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

constexpr double kSpacing = 0.001;
constexpr double kRadius = kSupportSpacings * kSpacing;

ZOrderedCloud resampled(Cloud dense) {
  const ZOrderedCloud points(std::move(dense));
  return points.subset(select_poisson_disk(points, kDistanceOverSpacing * kSpacing));
}

// A sphere of 20 mm with a round hole at the top, of this diameter measured along the chord.
ZOrderedCloud sphere_with_hole(double diameter) {
  constexpr double kSphere = 0.02;
  const double rim =
      diameter > 0.0 ? std::sqrt(kSphere * kSphere - 0.25 * diameter * diameter) : 1.0;
  const Cloud whole = random_sphere(80000, kSphere);
  Cloud open;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (whole.positions[i].z() < rim) {
      open.positions.push_back(whole.positions[i]);
      open.normals.push_back(whole.normals[i]);
    }
  }
  return resampled(std::move(open));
}

TEST(Gaps, AClosedSphereHasNone) {
  const Gaps gaps = find_gaps(sphere_with_hole(0.0), kSpacing, kRadius);
  EXPECT_TRUE(gaps.openings.empty());
  EXPECT_LT(gaps.largest_m, kRadius);
  EXPECT_GT(gaps.largest_m, kSpacing);
}

TEST(Gaps, AHoleIsFoundWithItsPlaceAndSize) {
  for (const double diameter : {0.004, 0.008, 0.015}) {
    const Gaps gaps = find_gaps(sphere_with_hole(diameter), kSpacing, kRadius);
    ASSERT_EQ(gaps.openings.size(), 1U) << diameter;
    const Opening& hole = gaps.openings[0];
    EXPECT_EQ(hole.kind, Opening::Kind::kHole);
    EXPECT_NEAR(hole.diameter_m, diameter, kSpacing);
    EXPECT_DOUBLE_EQ(gaps.largest_m, hole.diameter_m);
    const Eigen::Vector3d middle(0, 0, std::sqrt(0.02 * 0.02 - 0.25 * diameter * diameter));
    EXPECT_LT((hole.centre - middle).norm(), kSpacing);
  }
}

TEST(Gaps, TheBorderOfAnOpenSheetIsARimAndNoHole) {
  Cloud sheet = cosine_sheet(160, 0.06, 0.001, 150.0);
  for (const Eigen::Vector3d& p : sheet.positions) {
    sheet.normals.push_back(
        Eigen::Vector3d(0.15 * std::sin(150.0 * p.x()), 0.15 * std::sin(150.0 * p.y()), 1.0)
            .normalized()
            .cast<float>());
  }
  const Gaps gaps = find_gaps(resampled(std::move(sheet)), kSpacing, kRadius);
  ASSERT_EQ(gaps.openings.size(), 1U);
  EXPECT_EQ(gaps.openings[0].kind, Opening::Kind::kRim);
  EXPECT_NEAR(gaps.openings[0].diameter_m, 0.06 * std::sqrt(2.0), 2.0 * kSpacing);
  EXPECT_LT(gaps.largest_m, kRadius);
}

TEST(Gaps, TwoHolesInASheetAreTwo) {
  Cloud sheet;
  for (const Eigen::Vector3d& p : cosine_sheet(160, 0.06, 0.0, 1.0).positions) {
    const double left = (p - Eigen::Vector3d(-0.008, 0, 0)).norm();
    const double right = (p - Eigen::Vector3d(0.006, 0, 0)).norm();
    if (left > 0.005 && right > 0.003) {
      sheet.positions.push_back(p);
      sheet.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  const Gaps gaps = find_gaps(resampled(std::move(sheet)), kSpacing, kRadius);
  ASSERT_EQ(gaps.openings.size(), 3U);  // and the rim, which is the widest
  EXPECT_EQ(gaps.openings[0].kind, Opening::Kind::kRim);
  EXPECT_EQ(gaps.openings[1].kind, Opening::Kind::kHole);
  EXPECT_NEAR(gaps.openings[1].diameter_m, 0.010, kSpacing);
  EXPECT_NEAR(gaps.openings[1].centre.x(), -0.008, kSpacing);
  EXPECT_EQ(gaps.openings[2].kind, Opening::Kind::kHole);
  EXPECT_NEAR(gaps.openings[2].diameter_m, 0.006, kSpacing);
  EXPECT_DOUBLE_EQ(gaps.largest_m, gaps.openings[1].diameter_m);
}

TEST(Gaps, TheEdgesOfABoxAreNone) {
  const Gaps gaps =
      find_gaps(resampled(sample_faces(box_mesh({0, 0, 0}, {0.04, 0.03, 0.02}), kSpacing)),
                kSpacing, kRadius);
  EXPECT_LT(gaps.largest_m, kRadius);
  for (const Opening& opening : gaps.openings) {
    EXPECT_EQ(opening.kind, Opening::Kind::kRim);
    EXPECT_LT(opening.diameter_m, 4.0 * kRadius);
  }
  EXPECT_LE(gaps.openings.size(), 2U);
}

TEST(Gaps, TheSidesOfAThinPlateDoNotCloseEachOthersHoles) {
  Cloud plate;
  for (const double side : {1.0, -1.0}) {
    for (const Eigen::Vector3d& p : cosine_sheet(120, 0.04, 0.0, 1.0).positions) {
      if (side < 0.0 || p.norm() > 0.004) {  // the hole is in the upper side only
        plate.positions.push_back(p + Eigen::Vector3d(0, 0, side * 2e-4));
        plate.normals.emplace_back(0.0F, 0.0F, static_cast<float>(side));
      }
    }
  }
  const Gaps gaps = find_gaps(resampled(std::move(plate)), kSpacing, kRadius);
  EXPECT_NEAR(gaps.largest_m, 0.008, kSpacing);
}

}  // namespace
}  // namespace tactree::builder
