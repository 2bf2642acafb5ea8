#include <gtest/gtest.h>

#include <cmath>

#include "shapes.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {
namespace {

constexpr double kSpacing_m = 1e-3;
constexpr double kThickness_m = 3e-3;

// A sheet of 60 x 60 mm at z = 0 with a hole of 16 mm in its middle, or its triangles.
Scan sheet(bool mesh) {
  Scan scan;
  constexpr int kPoints = 61;
  for (int k = 0; k < kPoints * kPoints; ++k) {
    const Eigen::Vector3d p(kSpacing_m * (k % kPoints - 30), kSpacing_m * (k / kPoints - 30), 0.0);
    if (mesh || p.norm() > 8e-3) {
      scan.positions.push_back(p);
    }
  }
  for (std::uint32_t k = 0; mesh && k + kPoints < kPoints * kPoints; ++k) {
    if (k % kPoints != kPoints - 1) {
      scan.triangles.push_back({k, k + 1, k + kPoints});
      scan.triangles.push_back({k + kPoints, k + 1, k + kPoints + 1});
    }
  }
  return scan;
}

BuildResult built(const Scan& scan, std::optional<double> thickness) {
  Progress quiet;
  BuildOptions options;
  options.name = "sheet";
  options.spacing_m = kSpacing_m;
  options.two_sided_m = thickness;
  return build_model({scan}, options, quiet);
}

float distance_of(const BuildResult& model, float x, float y, float z) {
  core::BlobView view;
  EXPECT_EQ(core::open_blob(model.blob.bytes, view), core::BlobStatus::kOk);
  const core::SurfaceProjection at = core::project_to_surface(view, {x, y, z});
  return at.supported ? at.signed_distance : std::nanf("");
}

TEST(TwoSided, TouchesBothSidesAndEdges) {
  for (const bool mesh : {false, true}) {
    const BuildResult model = built(sheet(mesh), kThickness_m);
    EXPECT_NEAR(distance_of(model, 0.02F, 0.01F, 2.5e-3F), 1e-3, 1e-4);
    EXPECT_NEAR(distance_of(model, 0.02F, 0.01F, -2.5e-3F), 1e-3, 1e-4);
    EXPECT_NEAR(distance_of(model, 0.0325F, 0.0F, 0.0F), 1e-3, 5e-4);  // beside the edge
    if (!mesh) {
      EXPECT_NEAR(distance_of(model, 0.0055F, 0.0F, 0.0F), 1e-3, 7e-4);  // in the hole
    }
    EXPECT_TRUE(model.report.warnings.empty());
    EXPECT_TRUE(model.report.openings.empty());
  }
}

TEST(TwoSided, NamesMissingOption) {
  const BuildResult model = built(sheet(false), std::nullopt);
  EXPECT_LT(distance_of(model, 0.02F, 0.01F, -1e-3F), 0.0F);
  ASSERT_FALSE(model.report.warnings.empty());
  EXPECT_NE(model.report.warnings[0].find("--two-sided"), std::string::npos);
  EXPECT_EQ(std::count(model.doubtful.begin(), model.doubtful.end(), 1),
            static_cast<std::ptrdiff_t>(model.report.output_points));
}

TEST(TwoSided, RefusesThicknessBelowSpacing) {
  EXPECT_NO_THROW((void)built(sheet(false), 1.05e-3));
  EXPECT_THROW((void)built(sheet(false), 0.9e-3), BuildError);
}

TEST(TwoSided, RespectsFlashBudget) {
  Progress quiet;
  BuildOptions options;
  options.two_sided_m = kThickness_m;
  options.flash_budget_bytes = 30'000;
  const BuildResult model = build_model({sheet(true)}, options, quiet);
  EXPECT_LE(model.report.bytes, 30'000U);
  EXPECT_GE(model.report.bytes, 20'000U);
}

}  // namespace
}  // namespace tactree::builder
