#include "sampling/density.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

struct Chosen {
  DensityChoice choice;
  BuildReport report;
};

Scan box_scan() { return mesh_scan(box_mesh({-0.03, -0.02, -0.01}, {0.03, 0.02, 0.01})); }

Chosen choose(Scan scan, const BuildOptions& options) {
  Chosen chosen;
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  CleanInput input = clean(std::move(scans), options, chosen.report);
  Progress quiet;
  chosen.choice = choose_density(input, options, quiet, chosen.report);
  return chosen;
}

TEST(Density, KeepsGridOfRequestedSpacing) {
  for (const core::Profile profile : {core::Profile::kSurface, core::Profile::kPaper}) {
    BuildOptions options;
    options.profile = profile;
    options.spacing_m = 0.0025;
    const Chosen chosen = choose(cloud_scan(plane_grid(100, 0.0025)), options);
    EXPECT_EQ(chosen.choice.points.size(), 10000U);
    EXPECT_EQ(chosen.choice.spacing_m, 0.0025);
    EXPECT_TRUE(chosen.report.warnings.empty());
  }
}

/// A grid of edge `spacing` whose points are shifted by up to `shift` spacings.
Cloud shifted_grid(int n, double spacing, double shift) {
  Cloud cloud = plane_grid(n, spacing);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const auto seed = static_cast<std::uint64_t>(2 * i) + static_cast<std::uint64_t>(axis);
      cloud.positions[i][axis] += shift * spacing * (2.0 * unit_random(seed) - 1.0);
    }
  }
  return cloud;
}

Cloud independent_points(int n, double spacing) {
  Cloud cloud = plane_grid(n, spacing);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud.positions[i] = {n * spacing * unit_random(2 * i), n * spacing * unit_random(2 * i + 1),
                          0.0};
  }
  return cloud;
}

TEST(Density, KeepsEvenCloudAtSpacing) {
  for (const double shift : {0.1, 0.3, 0.45}) {
    BuildOptions options;
    options.spacing_m = 0.0025;
    const Chosen chosen = choose(cloud_scan(shifted_grid(100, 0.0025, shift)), options);
    EXPECT_GE(chosen.choice.points.size(), 9400U) << shift;
    EXPECT_NEAR(chosen.choice.spacing_m, 0.0025, 0.02 * 0.0025) << shift;
    EXPECT_TRUE(chosen.report.warnings.empty()) << shift;
    // Coarser: as many points as that spacing has.
    options.spacing_m = 1.2 * 0.0025;
    const Chosen coarser = choose(cloud_scan(shifted_grid(100, 0.0025, shift)), options);
    EXPECT_NEAR(static_cast<double>(coarser.choice.points.size()), 10000 / 1.44, 700) << shift;
    EXPECT_EQ(coarser.choice.spacing_m, *options.spacing_m);
  }
}

/// Its voids would be holes of the surface at that spacing.
TEST(Density, ThinsIndependentPointsEvenly) {
  BuildOptions options;
  options.spacing_m = 0.0025;
  const Chosen chosen = choose(cloud_scan(independent_points(100, 0.0025)), options);
  EXPECT_LE(chosen.choice.points.size(), 6000U);
  EXPECT_GT(chosen.choice.spacing_m, 1.15 * 0.0025);
  ASSERT_EQ(chosen.report.warnings.size(), 1U);
  EXPECT_NE(chosen.report.warnings[0].find("too coarse"), std::string::npos);
}

TEST(Density, SelectsEvenlyWithoutSpacing) {
  const Chosen chosen = choose(cloud_scan(shifted_grid(100, 0.0025, 0.3)), {});
  EXPECT_LE(chosen.choice.points.size(), 8000U);
}

TEST(Density, RaisesSpacingFinerThanCloud) {
  BuildOptions options;
  options.spacing_m = 0.0005;
  const Chosen chosen = choose(cloud_scan(plane_grid(100, 0.0025)), options);
  EXPECT_NEAR(chosen.choice.spacing_m, 0.0025, 0.1 * 0.0025);
  ASSERT_EQ(chosen.report.warnings.size(), 1U);
  EXPECT_NE(chosen.report.warnings[0].find("0.5 mm"), std::string::npos);
}

TEST(Density, ResamplesDenseCloudToSpacing) {
  BuildOptions options;
  options.spacing_m = 0.002;
  const Chosen chosen = choose(cloud_scan(random_sphere(200000, 0.03)), options);
  EXPECT_EQ(chosen.choice.spacing_m, 0.002);
  const double per_square = static_cast<double>(chosen.choice.points.size()) * 0.002 * 0.002 /
                            (4.0 * std::numbers::pi * 0.03 * 0.03);
  EXPECT_NEAR(per_square, 1.0, 0.06);
}

TEST(Density, KeepsEveryPointWithoutResampling) {
  BuildOptions options;
  options.resample = false;
  options.profile = core::Profile::kPaper;
  EXPECT_EQ(choose(cloud_scan(random_sphere(5000, 0.03)), options).choice.points.size(), 5000U);
  EXPECT_THROW((void)choose(box_scan(), options), std::runtime_error);
}

TEST(Density, SpacesMeshBySize) {
  const Chosen chosen = choose(box_scan(), {});
  EXPECT_NEAR(chosen.choice.spacing_m, 0.06 / 200.0, 1e-12);
  EXPECT_GT(chosen.report.sampled_points, 6U * chosen.choice.points.size());
}

TEST(Density, SpacesSlenderMeshByArea) {
  const Chosen chosen = choose(mesh_scan(box_mesh({0, 0, 0}, {1.0, 0.006, 0.006})), {});
  EXPECT_NEAR(chosen.choice.spacing_m, std::sqrt(4.0 * 0.006 / 20000.0), 2e-5);
}

TEST(Density, AcceptsMeshOfLargeArea) {
  Mesh stack = box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<std::array<std::uint32_t, 3>> faces = stack.triangles;
  for (int k = 0; k < 11; ++k) {
    stack.triangles.insert(stack.triangles.end(), faces.begin(), faces.end());
  }
  BuildOptions options;  // the samples are counted before the crop, which only saves time
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0.1, 0.1));
  const Chosen chosen = choose(mesh_scan(stack), options);
  EXPECT_GT(chosen.choice.spacing_m, 0.1 / 200.0);
  EXPECT_GT(chosen.report.sampled_points, 0U);
}

TEST(Density, OwnSpacingKeepsPoints) {
  const Scan scan = cloud_scan(random_sphere(20000, 0.03));
  const Chosen own = choose(scan, {});
  BuildOptions options;
  options.spacing_m = own.choice.spacing_m;
  const Chosen same = choose(scan, options);
  EXPECT_EQ(same.choice.points.size(), own.choice.points.size());
  EXPECT_TRUE(same.report.warnings.empty());
}

TEST(Density, UsesFlashBudgetWithoutExcess) {
  for (const core::Profile profile : {core::Profile::kSurface, core::Profile::kPaper}) {
    for (const std::uint64_t budget : {10000U, 60000U, 61000U, 62000U}) {
      BuildOptions options;
      options.profile = profile;
      options.flash_budget_bytes = budget;
      for (const bool mesh : {true, false}) {
        const Chosen chosen =
            choose(mesh ? box_scan() : cloud_scan(random_sphere(50000, 0.03)), options);
        Model model;
        model.positions = chosen.choice.points.positions();
        for (const Eigen::Vector3d& p : model.positions) {
          model.normals.push_back(
              p.normalized().cast<float>());  // of a body, which has an interior
        }
        model.tells_interior = true;
        model.spacing_m = chosen.choice.spacing_m;
        model.support_radius_m = kSupportSpacings * model.spacing_m;
        model.reach_m = kReachSpacings * model.spacing_m;
        model.profile = profile;
        const std::size_t bytes = write_blob(model).bytes.size();
        EXPECT_LE(bytes, budget);
        EXPECT_GT(static_cast<double>(bytes), 0.9 * static_cast<double>(budget));
      }
    }
  }
}

TEST(Density, KeepsScanWithinBudget) {
  BuildOptions options;
  options.flash_budget_bytes = 10000000;
  const Chosen chosen = choose(cloud_scan(plane_grid(100, 0.0025)), options);
  EXPECT_EQ(chosen.choice.points.size(), 10000U);
}

TEST(Density, TellsThatRandomPointsAreThinned) {
  BuildOptions options;
  const Chosen random = choose(cloud_scan(random_sphere(6000, 0.03)), options);
  EXPECT_LT(random.choice.points.size(), 4500U);
  ASSERT_EQ(random.report.notes.size(), 1U);
  EXPECT_NE(random.report.notes[0].find("spread unevenly"), std::string::npos);
  options.resample = false;
  EXPECT_TRUE(choose(cloud_scan(random_sphere(6000, 0.03)), options).report.notes.empty());
  EXPECT_TRUE(choose(cloud_scan(plane_grid(100, 0.0025)), {}).report.notes.empty());
}

TEST(Density, RefusesBudgetBelowHeader) {
  BuildOptions options;
  options.flash_budget_bytes = 300;
  EXPECT_THROW((void)choose(box_scan(), options), std::runtime_error);
}

}  // namespace
}  // namespace tactree::builder
