// The warnings of a build: each for the scan that has its fault, and none for a sound scan.

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "shapes.hpp"
#include "warnings_of.hpp"

namespace tactree::builder {
namespace {

Scan sphere(double radius = 0.03, std::size_t points = 5000) {
  return cloud_scan(even_sphere(points, radius));
}

Scan box() {
  return mesh_scan(
      box_mesh(Eigen::Vector3d(-0.03, -0.02, -0.01), Eigen::Vector3d(0.03, 0.02, 0.01)));
}

/// The sphere after a change of each normal or position.
Scan changed(const std::function<void(Eigen::Vector3d&, Eigen::Vector3f&, std::uint64_t)>& change) {
  Scan scan = sphere();
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    change(scan.positions[i], scan.normals[i], i);
  }
  return scan;
}

void expect_only(const std::vector<std::string>& warnings, const std::string& part) {
  ASSERT_EQ(warnings.size(), 1U) << part << (warnings.empty() ? "" : ": " + warnings.back());
  EXPECT_NE(warnings[0].find(part), std::string::npos) << part << ": " << warnings[0];
}

TEST(BuildWarnings, AreAbsentForSoundScans) {
  EXPECT_EQ(warnings_of(sphere()), std::vector<std::string>{});
  EXPECT_EQ(warnings_of(box()), std::vector<std::string>{});
  Scan bare = sphere();
  bare.normals.clear();
  EXPECT_EQ(warnings_of(std::move(bare)), std::vector<std::string>{});
}

TEST(BuildWarnings, ReportSizesThatAreProbablyOfAnotherUnit) {
  expect_only(warnings_of(sphere(3.0)), "5.999 m wide, but a haptic device reaches");
  expect_only(warnings_of(sphere(0.001)), "2 mm wide, too small to feel");
  BuildOptions options;
  options.unit_m = 1.0;
  EXPECT_EQ(warnings_of(sphere(3.0), options), std::vector<std::string>{});
}

TEST(BuildWarnings, ReportNormalsAndWindings) {
  expect_only(warnings_of(changed([](auto&, auto& normal, auto) { normal = -normal; })),
              "5000 normals of the file pointed inwards");
  expect_only(warnings_of(changed([](auto&, auto& normal, std::uint64_t i) {
                if (unit_random(i) < 0.5) normal = -normal;
              })),
              "the normals of the file contradict each other");
  Scan mesh = box();
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  expect_only(warnings_of(std::move(mesh)), "1 of 12 faces had inward windings");
}

TEST(BuildWarnings, ReportAmbiguousOrientation) {
  expect_only(warnings_of(cloud_scan(plane_grid(40, 0.001))), "it is a sheet");
  Scan open = box();
  open.triangles.resize(2);  // one side
  expect_only(warnings_of(std::move(open)), "they form open sheets");
}

TEST(BuildWarnings, ReportCoarseScans) {
  BuildOptions options;
  options.spacing_m = 0.0001;
  expect_only(warnings_of(sphere(), options), "too coarse for a spacing of 0.1 mm");
  options.spacing_m = 0.002;
  EXPECT_EQ(warnings_of(sphere(), options), std::vector<std::string>{});
  expect_only(warnings_of(sphere(0.03, 90)), "the model has only 90 points");
}

double rounded_to_float(double value) {
  const volatile float stored = static_cast<float>(value);  // GCC 12 omits the rounding in vectors
  return static_cast<double>(stored);
}

TEST(BuildWarnings, ReportRoundedCoordinates) {
  const auto moved = [](bool rounded) {
    return changed([=](Eigen::Vector3d& position, auto&, auto) {
      position.x() += 10000.0;
      if (rounded) position = position.unaryExpr(&rounded_to_float);
    });
  };
  EXPECT_EQ(warnings_of(moved(false)), std::vector<std::string>{});
  const std::vector<std::string> warnings = warnings_of(moved(true));
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("float32 numbers far from their origin"), std::string::npos);
}

}  // namespace
}  // namespace tactree::builder
