// The surface between the points, on shapes whose distances and normals are known.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "analytic_shapes.hpp"
#include "errors.hpp"
#include "tactree/core/contact/surface.hpp"

namespace tactree::test {
namespace {

constexpr int kProbes = 20'000;

TEST(Fit, MatchesSphereWithinMicrometres) {
  const Shape shape = sphere();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Errors distance;
  Errors normal;
  Errors signed_distance;
  for (int i = 0; i < kProbes; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    const Eigen::Vector3d probe = direction * (kSphereRadius + 1e-3 * unit(random));
    const core::SurfaceProjection p = core::project_to_surface(shape.view(), narrow(probe));
    ASSERT_TRUE(p.supported);
    const Eigen::Vector3d point = widen(p.point);
    distance.add(point.norm() - kSphereRadius);
    normal.add(angle_deg(widen(p.normal), point));
    signed_distance.add(static_cast<double>(p.signed_distance) - (probe.norm() - kSphereRadius));
  }
  // Points are rounded to sites of 6 um, mostly along the surface: far below is a broken test.
  EXPECT_LE(distance.rms(), 1.0e-6);
  EXPECT_GE(distance.rms(), 0.1e-6);
  EXPECT_LE(distance.largest(), 5e-6);
  EXPECT_LE(normal.rms(), 0.25);
  EXPECT_GE(normal.rms(), 0.01);
  EXPECT_LE(signed_distance.largest(), 5e-6);
}

TEST(Fit, MatchesCosineSheetWithinMicrometres) {
  const CosSheet sheet;
  const Shape shape = cos_sheet(sheet);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Errors distance;
  Errors normal;
  for (int i = 0; i < kProbes; ++i) {
    const double x = 0.035 * unit(random);
    const double y = 0.035 * unit(random);
    const Eigen::Vector3d probe = sheet.point(x, y) + 1e-3 * unit(random) * sheet.normal(x, y);
    const core::SurfaceProjection p = core::project_to_surface(shape.view(), narrow(probe));
    ASSERT_TRUE(p.supported);
    const Eigen::Vector3d point = widen(p.point);
    const Eigen::Vector3d truth = sheet.normal(point.x(), point.y());
    distance.add((point.z() - sheet.height(point.x(), point.y())) * truth.z());
    normal.add(angle_deg(widen(p.normal), truth));
  }
  EXPECT_LE(distance.rms(), 1.0e-6);
  EXPECT_GE(distance.rms(), 0.1e-6);
  EXPECT_LE(distance.largest(), 5e-6);
  EXPECT_LE(normal.rms(), 0.25);
  EXPECT_GE(normal.rms(), 0.01);
}

TEST(Fit, SeparatesSidesOfThinPlate) {
  const double thickness = 0.5 * kSpacing;
  const Shape shape = plate(thickness);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const double height = 0.5 * kSpacing + std::abs(unit(random)) * kSpacing;
    const Eigen::Vector3d probe(0.015 * unit(random), 0.015 * unit(random),
                                side * (0.5 * thickness + height));
    const core::SurfaceProjection p = core::project_to_surface(shape.view(), narrow(probe));
    ASSERT_TRUE(p.supported);
    EXPECT_NEAR(static_cast<double>(p.normal.z), side, 1e-3);
    EXPECT_NEAR(static_cast<double>(p.point.z), side * 0.5 * thickness, 5e-6);
    EXPECT_NEAR(static_cast<double>(p.signed_distance), height, 5e-6);
  }
}

TEST(Fit, ReturnsNothingForEmptySet) {
  core::NearFaces near;
  const core::SurfaceFit fit = core::fit_surface({}, {}, 1e-3F, {0.0F, 0.0F, 1.0F}, 1.0F, near);
  EXPECT_FALSE(fit.supported);
  EXPECT_EQ(fit.normal, core::Vec3{});
  EXPECT_FALSE(fit.firm());
}

TEST(Fit, FadesSmoothlyBeyondBoundary) {
  const double half = 0.01;
  const Shape shape = plane(half);
  const auto radius = shape.view().header().support_radius_m;
  core::CandidateSet set;
  float last = 1.0F;
  double where_it_ends = 0.0;
  for (double x = 0.0; x < half + 0.003; x += 1e-5) {
    const core::Vec3 position = narrow({x, 0.2e-3, 0.0});
    set.cover(shape.view(), position);
    core::NearFaces near;
    const core::SurfaceFit fit =
        core::fit_surface(set, position, radius, {0.0F, 0.0F, 1.0F}, 1.0F, near);
    if (x < half) {
      ASSERT_EQ(fit.strength, 1.0F) << x;
    }
    ASSERT_LE(std::abs(last - fit.strength), 0.05F) << x;
    last = fit.strength;
    where_it_ends = fit.supported ? x : where_it_ends;
  }
  EXPECT_EQ(last, 0.0F);
  EXPECT_GT(where_it_ends, half + 0.5e-3);
  EXPECT_LT(where_it_ends, half + static_cast<double>(radius));
}

TEST(Fit, HasNoSupportWithoutPoints) {
  const Shape shape = plane();
  EXPECT_FALSE(core::project_to_surface(shape.view(), {0.0F, 0.0F, 0.0026F}).supported);
  EXPECT_TRUE(core::project_to_surface(shape.view(), {0.0F, 0.0F, 0.0024F}).supported);
  EXPECT_FALSE(core::project_to_surface(shape.view(), {1e9F, 0.0F, 0.0F}).supported);
  EXPECT_FALSE(core::project_to_surface(core::BlobView{}, {0.0F, 0.0F, 0.0F}).supported);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(core::project_to_surface(shape.view(), {nan, 0.0F, 0.0F}).supported);
  EXPECT_FALSE(core::project_to_surface(shape.view(), {0.0F, -infinity, 0.0F}).supported);
}

// Every query within the slack of a gather must see all points in its support.
TEST(Candidates, HoldsEverySupportPoint) {
  const Shape shape = sphere();
  const core::BlobView& view = shape.view();
  std::vector<Eigen::Vector3d> all;
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {
      all.push_back(widen(view.position(leaf, leaf.first_point + i)));
    }
  }
  const double radius = static_cast<double>(view.header().support_radius_m);
  const double slack = static_cast<double>(view.reach_m()) - radius;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    const Eigen::Vector3d centre = direction * (kSphereRadius + 1e-3 * unit(random));
    core::CandidateSet set;
    set.cover(view, narrow(centre));
    const Eigen::Vector3d shift =
        0.57 * slack * Eigen::Vector3d(unit(random), unit(random), unit(random));
    const core::Vec3 x = narrow(centre + shift);
    set.cover(view, x);
    ASSERT_TRUE(set.complete());
    std::set<std::uint32_t> points;
    for (std::uint32_t k = 0; k < set.count(); ++k) {
      points.insert(set[k].point);
    }
    ASSERT_EQ(points.size(), set.count());
    for (std::uint32_t k = 0; k < all.size(); ++k) {
      if ((all[k] - widen(x)).norm() < 0.9999 * radius) {
        ASSERT_EQ(points.count(k), 1U);
      }
    }
  }
}

TEST(SurfaceSupport, ReportsReasonForNoSurface) {
  EXPECT_EQ(core::surface_support(core::BlobView{}), core::SurfaceSupport::kEmpty);
  EXPECT_EQ(core::surface_support(plane().view()), core::SurfaceSupport::kOk);

  Shape crowded;  // 200 points within one support radius
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    crowded.add({1e-3 * unit(random), 1e-3 * unit(random), 1e-3 * unit(random)}, {0.0, 0.0, 1.0});
  }
  crowded.seal();
  EXPECT_EQ(core::surface_support(crowded.view()), core::SurfaceSupport::kTooManyPoints);
}

}  // namespace
}  // namespace tactree::test
