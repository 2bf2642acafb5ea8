#include "openings/gaps.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "sampling/resample.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

constexpr double kSpacing = 0.001;
constexpr double kRadius = kSupportSpacings * kSpacing;

ZOrderedCloud resampled(Cloud dense) {
  const ZOrderedCloud points(std::move(dense));
  return points.subset(select_poisson_disk(points, kDistanceOverSpacing * kSpacing));
}

// A sphere of 20 mm with a round hole at the top; `diameter` is that of the chord.
ZOrderedCloud sphere_with_hole(double diameter) {
  constexpr double kSphere = 0.02;
  const double boundary =
      diameter > 0.0 ? std::sqrt(kSphere * kSphere - 0.25 * diameter * diameter) : 1.0;
  const Cloud whole = random_sphere(80000, kSphere);
  Cloud open;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (whole.positions[i].z() < boundary) {
      open.positions.push_back(whole.positions[i]);
      open.normals.push_back(whole.normals[i]);
    }
  }
  return resampled(std::move(open));
}

TEST(Gaps, AreAbsentInClosedSphere) {
  const Gaps gaps = find_gaps(sphere_with_hole(0.0), kSpacing, kRadius);
  EXPECT_TRUE(gaps.openings.empty());
  EXPECT_LT(gaps.largest_m, kRadius);
  EXPECT_GT(gaps.largest_m, kSpacing);
}

TEST(Gaps, FindsHolePositionAndSize) {
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

// Where a random cloud is less dense than the spacing requires, the border points of its voids lie
// beside each other.
TEST(Gaps, AreAbsentInSparseRandomCloud) {
  constexpr double kPerSquareSpacing = 1.6;
  const auto count =
      static_cast<std::size_t>(kPerSquareSpacing * 4.0 * std::numbers::pi * 60.0 * 60.0);
  const Gaps gaps = find_gaps(resampled(random_sphere(count, 0.06)), kSpacing, kRadius);
  EXPECT_TRUE(gaps.openings.empty()) << gaps.openings.size();
  EXPECT_LT(gaps.largest_m, kBridgedSpacings * kSpacing);
}

TEST(Gaps, OmitsHolesThatAreBridged) {
  const Gaps gaps = find_gaps(sphere_with_hole(0.0032), kSpacing, kRadius);
  EXPECT_TRUE(gaps.openings.empty());
  EXPECT_NEAR(gaps.largest_m, 0.0032, 0.6 * kSpacing);
}

// A row of border points on either side, of which only those opposite each other show its width.
TEST(Gaps, FindsLongCrack) {
  Cloud sheet;
  for (int x = -460; x <= 460; ++x) {
    for (int y = -20; y <= 20; ++y) {
      if (std::abs(x) > 420 || std::abs(y) > 2) {
        sheet.positions.emplace_back(1e-3 * x, 1e-3 * y, 0.0);
        sheet.normals.push_back(Eigen::Vector3f::UnitZ());
      }
    }
  }
  const Gaps gaps = find_gaps(ZOrderedCloud(std::move(sheet)), kSpacing, kRadius);
  ASSERT_EQ(gaps.openings.size(), 2U);  // and the boundary
  EXPECT_EQ(gaps.openings[1].kind, Opening::Kind::kHole);
  EXPECT_NEAR(gaps.openings[1].diameter_m, 0.006, 0.5 * kSpacing);
}

TEST(Gaps, ClassifiesSheetBorderAsBoundary) {
  Cloud sheet = cosine_sheet(160, 0.06, 0.001, 150.0);
  for (const Eigen::Vector3d& p : sheet.positions) {
    sheet.normals.push_back(
        Eigen::Vector3d(0.15 * std::sin(150.0 * p.x()), 0.15 * std::sin(150.0 * p.y()), 1.0)
            .normalized()
            .cast<float>());
  }
  const Gaps gaps = find_gaps(resampled(std::move(sheet)), kSpacing, kRadius);
  ASSERT_EQ(gaps.openings.size(), 1U);
  EXPECT_EQ(gaps.openings[0].kind, Opening::Kind::kBoundary);
  EXPECT_NEAR(gaps.openings[0].diameter_m, 0.06 * std::sqrt(2.0), 2.0 * kSpacing);
  EXPECT_LT(gaps.largest_m, kRadius);
}

TEST(Gaps, FindsTwoHolesInSheet) {
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
  ASSERT_EQ(gaps.openings.size(), 3U);  // and the boundary, which is the widest
  EXPECT_EQ(gaps.openings[0].kind, Opening::Kind::kBoundary);
  EXPECT_EQ(gaps.openings[1].kind, Opening::Kind::kHole);
  EXPECT_NEAR(gaps.openings[1].diameter_m, 0.010, kSpacing);
  EXPECT_NEAR(gaps.openings[1].centre.x(), -0.008, kSpacing);
  EXPECT_EQ(gaps.openings[2].kind, Opening::Kind::kHole);
  EXPECT_NEAR(gaps.openings[2].diameter_m, 0.006, kSpacing);
  EXPECT_DOUBLE_EQ(gaps.largest_m, gaps.openings[1].diameter_m);
}

// A prism over a polygon that is star-shaped around the origin, turned by a random rotation.
Mesh prism(const std::vector<Eigen::Vector2d>& outline, double height, std::uint64_t turn) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, height}) {
    for (const Eigen::Vector2d& p : outline) {
      mesh.positions.emplace_back(p.x(), p.y(), z);
    }
  }
  mesh.positions.emplace_back(0.0, 0.0, 0.0);
  mesh.positions.emplace_back(0.0, 0.0, height);
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    mesh.triangles.push_back({2 * n, next, k});
    mesh.triangles.push_back({2 * n + 1, n + k, n + next});
    mesh.triangles.push_back({k, next, n + next});
    mesh.triangles.push_back({k, n + next, n + k});
  }
  const Eigen::Vector3d axis(unit_random(turn) - 0.5, unit_random(turn + 1) - 0.5, 0.3);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(6.0 * unit_random(turn + 2), axis.normalized()).toRotationMatrix();
  for (Eigen::Vector3d& p : mesh.positions) {
    p = rotation * p;
  }
  return mesh;
}

std::vector<Eigen::Vector2d> gear(int teeth, double inner, double outer) {
  std::vector<Eigen::Vector2d> outline;
  for (int k = 0; k < 4 * teeth; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / (4.0 * teeth);
    const double radius = k % 4 < 2 ? outer : inner;
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return outline;
}

struct Part {
  const char* name;
  std::vector<Eigen::Vector2d> outline;
  double height;
};

std::vector<Part> watertight_parts() {
  const std::vector<Eigen::Vector2d> square = {
      {-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.02}, {-0.02, 0.02}};
  const std::vector<Eigen::Vector2d> bracket = {{-0.004, -0.004}, {0.03, -0.004}, {0.03, 0.004},
                                                {0.004, 0.004},   {0.004, 0.03},  {-0.004, 0.03}};
  std::vector<Part> parts = {
      {"cube", square, 0.04}, {"bracket", bracket, 0.01}, {"gear", gear(16, 0.018, 0.024), 0.006}};
  for (const double height : {0.2, 0.5, 1.0, 1.5, 2.0, 3.0}) {
    parts.push_back({"plate", square, height * kSpacing});
  }
  return parts;
}

TEST(Gaps, AreAbsentInWatertightParts) {
  for (const Part& part : watertight_parts()) {
    for (std::uint64_t turn = 1; turn < 100; turn += 10) {
      const Mesh mesh = prism(part.outline, part.height, turn);
      const Gaps gaps = find_gaps(resampled(sample_faces(mesh, kSpacing)), kSpacing, kRadius);
      EXPECT_LT(gaps.largest_m, kRadius) << part.name << ' ' << part.height;
      EXPECT_EQ(gaps.openings.size(), 0U) << part.name << ' ' << part.height;
    }
  }
}

TEST(Gaps, FindsMissingBoxLid) {
  Mesh box = box_mesh({0, 0, 0}, {0.03, 0.03, 0.02});
  std::erase_if(box.triangles, [&](const std::array<std::uint32_t, 3>& t) {
    return box.positions[t[0]].z() > 0.01 && box.positions[t[1]].z() > 0.01 &&
           box.positions[t[2]].z() > 0.01;
  });
  const Gaps gaps = find_gaps(resampled(sample_faces(box, kSpacing)), kSpacing, kRadius);
  ASSERT_EQ(gaps.openings.size(), 1U);
  EXPECT_NEAR(gaps.openings[0].diameter_m, 0.03 * std::sqrt(2.0), 2.0 * kSpacing);
  EXPECT_EQ(
      find_gaps(resampled(sample_faces(box, kSpacing)), kSpacing, kRadius, true).openings.size(),
      0U);
}

TEST(Gaps, FindsHoleInPlateSide) {
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
