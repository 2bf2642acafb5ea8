#include "cleaning/stray_points.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "geometry/spacing.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

constexpr double kSigma = 3.0;

/// The first `scan` points of the cloud are of the scan, the rest stray; marked by material.
struct Tried {
  double lost = 0.0;     ///< share of the scan
  double removed = 0.0;  ///< share of the stray points beyond some spacings
  SurfacePoints found;
};

/// `part` stray points for each point of the scan, at random in its bounding box.
Tried try_with(Cloud cloud, double part, double (*distance)(const Eigen::Vector3d&),
               double beyond = 3.0) {
  const std::size_t scan = cloud.size();
  const Box box = bounds_of(cloud.positions);
  cloud = without_normals(std::move(cloud));
  cloud.materials.assign(scan, 0);
  const double spacing = estimate_spacing(ZOrderedCloud(cloud)).median_m;
  const auto count = static_cast<std::uint64_t>(part * static_cast<double>(scan));
  std::size_t far = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    const Eigen::Vector3d at(unit_random(3 * i + 77), unit_random(3 * i + 78),
                             unit_random(3 * i + 79));
    cloud.positions.emplace_back(box.min() + at.cwiseProduct(box.sizes()));
    cloud.materials.push_back(distance(cloud.positions.back()) > beyond * spacing ? 2 : 1);
    far += cloud.materials.back() == 2 ? 1U : 0U;
  }
  const ZOrderedCloud points(std::move(cloud));
  Tried tried;
  tried.found = points_on_surfaces(points, estimate_spacing(points).median_m, kSigma);
  std::size_t of_scan = 0;
  std::size_t of_far = 0;
  for (const std::uint32_t i : tried.found.kept) {
    of_scan += points.cloud().materials[i] == 0 ? 1U : 0U;
    of_far += points.cloud().materials[i] == 2 ? 1U : 0U;
  }
  tried.lost = 1.0 - static_cast<double>(of_scan) / static_cast<double>(scan);
  tried.removed = far == 0 ? 1.0 : 1.0 - static_cast<double>(of_far) / static_cast<double>(far);
  return tried;
}

double from_sphere(const Eigen::Vector3d& p) { return std::abs(p.norm() - 0.1); }

double from_ground(const Eigen::Vector3d& p) {
  return std::abs(p.z() - 0.01 * (std::cos(60.0 * p.x()) + std::cos(60.0 * p.y())));
}

TEST(StrayPoints, AreRemovedAroundSphere) {
  for (const double part : {0.005, 0.05}) {
    const Tried tried = try_with(random_sphere(30000, 0.1), part, from_sphere);
    EXPECT_GE(tried.removed, 0.99) << part;
    EXPECT_LE(tried.lost, 0.001) << part;
  }
}

TEST(StrayPoints, AreRemovedNearSurface) {
  EXPECT_GE(try_with(random_sphere(30000, 0.1), 0.01, from_sphere, 1.0).removed, 0.95);
  EXPECT_GE(try_with(cosine_sheet(170, 0.2, 0.01, 60.0), 0.005, from_ground, 1.0).removed, 0.95);
}

double from_plate(const Eigen::Vector3d& p) {
  return std::min(std::abs(p.z()), std::abs(p.z() - 0.006));
}

TEST(StrayPoints, AreRemovedInsidePlate) {
  Cloud plate = plane_grid(100, 0.001);
  for (const Eigen::Vector3d& p : plane_grid(100, 0.001).positions) {
    plate.positions.emplace_back(p.x() + 0.0003, p.y() + 0.0004, 0.006);
  }
  const Tried tried = try_with(std::move(plate), 0.01, from_plate, 1.0);
  EXPECT_GE(tried.removed, 0.9);
  EXPECT_LE(tried.lost, 0.001);
}

TEST(StrayPoints, AreRemovedFromNoisySheet) {
  Cloud sheet = cosine_sheet(170, 0.2, 0.01, 60.0);
  const double noise = 0.35 * 0.2 / 170.0;
  for (std::uint64_t i = 0; i < sheet.size(); ++i) {
    sheet.positions[i].z() += noise * (2.0 * unit_random(i + 999) - 1.0);
  }
  const Tried tried = try_with(std::move(sheet), 0.02, from_ground);
  EXPECT_GE(tried.removed, 0.95);
  EXPECT_LE(tried.lost, 0.001);
}

TEST(StrayPoints, AreAbsentInCleanScan) {
  EXPECT_LE(try_with(random_sphere(30000, 0.1), 0.0, from_sphere).lost, 1e-4);
  EXPECT_LE(try_with(cosine_sheet(100, 0.2, 0.01, 60.0), 0.0, from_ground).lost, 1e-4);
}

TEST(StrayPoints, LeaveThinPlatesAndWires) {
  Cloud cloud = plane_grid(120, 1e-3);
  for (const Eigen::Vector3d& p : plane_grid(120, 1e-3).positions) {
    cloud.positions.emplace_back(p + Eigen::Vector3d(0.0004, 0.0004, 0.001));
  }
  for (int k = 0; k < 400; ++k) {  // a wire of 1 mm: three points around it for each of its rings
    const double angle = 2.1 * k;
    cloud.positions.emplace_back(0.06 + 0.0005 * std::cos(angle), 0.06 + 0.0005 * std::sin(angle),
                                 0.003 + 0.0003 * k);
  }
  EXPECT_LE(try_with(std::move(cloud), 0.0, from_ground).lost, 0.001);
}

TEST(StrayPoints, LeaveSparseScanPart) {
  Cloud cloud;
  for (const Eigen::Vector3d& p : random_sphere(40000, 0.1).positions) {
    if (p.z() > 0.0 || unit_random(static_cast<std::uint64_t>(1e9 * (p.x() + 0.1))) < 0.04) {
      cloud.positions.push_back(p);
    }
  }
  EXPECT_LE(try_with(std::move(cloud), 0.0, from_sphere).lost, 0.001);
}

TEST(StrayPoints, AreKeptIfNumerous) {
  const Tried tried = try_with(random_sphere(20000, 0.1), 0.5, from_sphere);
  EXPECT_TRUE(tried.found.undecided);
  EXPECT_EQ(tried.found.kept.size(), 30000U);
}

TEST(StrayPoints, AreIndependentOfThreads) {
  const Tried many = try_with(random_sphere(20000, 0.1), 0.03, from_sphere);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(try_with(random_sphere(20000, 0.1), 0.03, from_sphere).found.kept, many.found.kept);
}

}  // namespace
}  // namespace tactree::builder
