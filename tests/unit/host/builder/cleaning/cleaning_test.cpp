#include "cleaning/cleaning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

struct Cleaned {
  CleanInput input;
  BuildReport report;
};

Cleaned clean_one(Scan scan, const BuildOptions& options = {}) {
  Cleaned cleaned;
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  cleaned.input = clean(std::move(scans), options, cleaned.report);
  return cleaned;
}

// model = source_scale * turn * (source - source_origin), for any options.
void expect_recorded(const BuildOptions& options, const Eigen::Vector3d& place) {
  Cloud cloud = without_normals(even_sphere(500, 2.0));
  for (Eigen::Vector3d& p : cloud.positions) {
    p += place;
  }
  const std::vector<Eigen::Vector3d> source = cloud.positions;
  const Cleaned cleaned = clean_one(cloud_scan(std::move(cloud)), options);
  const ModelFrame& frame = cleaned.input.frame;
  ASSERT_EQ(cleaned.input.points.size(), source.size());
  for (const Eigen::Vector3d& p : source) {
    const Eigen::Vector3d expected =
        cleaned.report.source_scale * (frame.turn * (p - cleaned.report.source_origin));
    double nearest = 1e300;
    for (const Eigen::Vector3d& q : cleaned.input.points.positions()) {
      nearest = std::min(nearest, (q - expected).norm());
    }
    ASSERT_LT(nearest, 1e-12 * (1.0 + place.norm()));
  }
}

TEST(ModelFrame, IsRecordedForAllOptions) {
  BuildOptions options;
  expect_recorded(options, {0, 0, 0});
  expect_recorded(options, {500000.0, 5600000.0, 300.0});
  options.unit_m = 0.001;
  options.scale = 3.0;
  expect_recorded(options, {1.0, 2.0, 3.0});
  options.centre = true;
  options.up = UpAxis::kY;
  expect_recorded(options, {1.0, 2.0, 3.0});
  options.scale = 1.0;
  options.fit_m = 0.2;
  options.up = UpAxis::kX;
  expect_recorded(options, {100.0, 2.0, 3.0});
  options.turn_deg = 25.0;
  expect_recorded(options, {100.0, 2.0, 3.0});
}

TEST(ModelFrame, KeepsScanNearOrigin) {
  const Cleaned cleaned = clean_one(cloud_scan(random_sphere(1000, 0.05)));
  EXPECT_EQ(cleaned.report.source_origin, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(cleaned.report.source_scale, 1.0);
  EXPECT_TRUE(cleaned.report.notes.empty());
}

TEST(ModelFrame, ShiftsFarScanWithNote) {
  Cloud cloud = plane_grid(30, 1e-3);
  for (Eigen::Vector3d& p : cloud.positions) {
    p += Eigen::Vector3d(665187.522, 5648349.895, 241.75);
  }
  const Cleaned cleaned = clean_one(cloud_scan(std::move(cloud)));
  EXPECT_EQ(cleaned.report.notes.size(), 1U);
  EXPECT_LT(cleaned.input.bounds.center().norm(), 1e-8);
  EXPECT_NEAR(cleaned.report.source_origin.y(), 5648349.895 + 0.0145, 1e-6);
  EXPECT_EQ(cleaned.input.points.size(), 900U);
}

TEST(ModelFrame, FitsLongestEdgeAndCentres) {
  BuildOptions options;
  options.fit_m = 0.25;
  const Cleaned cleaned =
      clean_one(mesh_scan(box_mesh({10.0, 20.0, 30.0}, {14.0, 22.0, 31.0})), options);
  EXPECT_NEAR(cleaned.input.bounds.sizes().x(), 0.25, 1e-12);
  EXPECT_NEAR(cleaned.input.bounds.sizes().y(), 0.125, 1e-12);
  EXPECT_LT(cleaned.input.bounds.center().norm(), 1e-12);
  EXPECT_NEAR(cleaned.report.source_scale, 0.0625, 1e-12);
}

TEST(ModelFrame, RotationKeepsHandednessAndNormals) {
  for (const UpAxis up : {UpAxis::kX, UpAxis::kY, UpAxis::kZ}) {
    BuildOptions options;
    options.up = up;
    const Cleaned cleaned = clean_one(cloud_scan(even_sphere(300, 1.0)), options);
    const Eigen::Vector3d source_up = Eigen::Vector3d::Unit(static_cast<int>(up));
    EXPECT_NEAR(cleaned.input.frame.turn.determinant(), 1.0, 1e-15);
    EXPECT_EQ(Eigen::Vector3d(cleaned.input.frame.turn * source_up), Eigen::Vector3d(0, 0, 1));
    for (std::size_t i = 0; i < cleaned.input.points.size(); ++i) {
      ASSERT_GT(
          cleaned.input.points.normals()[i].cast<double>().dot(cleaned.input.points.positions()[i]),
          0.999);
    }
  }
}

// The front of a file with y up is the side of its z, as in a glTF.
TEST(ModelFrame, PermutesAxesInCyclicOrder) {
  const auto turned = [](UpAxis up, const Eigen::Vector3d& source) -> Eigen::Vector3d {
    BuildOptions options;
    options.up = up;
    return clean_one(cloud_scan(even_sphere(300, 1.0)), options).input.frame.turn * source;
  };
  EXPECT_EQ(turned(UpAxis::kZ, {1, 2, 3}), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(turned(UpAxis::kY, {1, 2, 3}), Eigen::Vector3d(3, 1, 2));
  EXPECT_EQ(turned(UpAxis::kX, {1, 2, 3}), Eigen::Vector3d(2, 3, 1));
}

TEST(ModelFrame, TurnsAboutVerticalAfterAxis) {
  BuildOptions options;
  options.up = UpAxis::kY;
  options.turn_deg = 90.0;
  const Eigen::Matrix3d quarter =
      clean_one(cloud_scan(even_sphere(300, 1.0)), options).input.frame.turn;
  EXPECT_EQ(Eigen::Vector3d(quarter * Eigen::Vector3d(0, 1, 0)), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(Eigen::Vector3d(quarter * Eigen::Vector3d(0, 0, 1)), Eigen::Vector3d(0, 1, 0));
  for (const double degrees : {-200.0, -90.0, 30.0, 180.0, 300.0, 360.0}) {
    options.turn_deg = degrees;
    const Cleaned cleaned = clean_one(cloud_scan(even_sphere(300, 1.0)), options);
    const Eigen::Vector3d x = cleaned.input.frame.turn * Eigen::Vector3d(0, 0, 1);
    const double angle = degrees * std::numbers::pi / 180.0;
    EXPECT_LT((x - Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0)).norm(), 1e-15);
    EXPECT_NEAR(cleaned.input.frame.turn.determinant(), 1.0, 1e-15);
    for (std::size_t i = 0; i < cleaned.input.points.size(); ++i) {
      ASSERT_GT(
          cleaned.input.points.normals()[i].cast<double>().dot(cleaned.input.points.positions()[i]),
          0.999);
    }
  }
}

TEST(ModelFrame, GivenUnitOverridesFileUnit) {
  Scan scan = cloud_scan(random_sphere(2000, 10.0));
  scan.unit_m = 0.01;
  BuildOptions options;
  EXPECT_NEAR(clean_one(scan, options).input.bounds.sizes().x(), 0.2, 0.002);
  options.unit_m = 0.001;
  EXPECT_NEAR(clean_one(scan, options).input.bounds.sizes().x(), 0.02, 0.0002);
}

TEST(ModelFrame, JoinsScansOfDifferentUnits) {
  Scan metres = cloud_scan(random_sphere(2000, 0.1));
  Scan millimetres = cloud_scan(random_sphere(2000, 300.0));
  millimetres.unit_m = 0.001;
  BuildReport report;
  EXPECT_NEAR(clean({metres, millimetres}, {}, report).bounds.sizes().x(), 0.6, 0.006);
  EXPECT_NEAR(clean({millimetres, metres}, {}, report).bounds.sizes().x(), 0.6, 0.006);
}

TEST(Cleaning, WarnsOfCoarseFloatCoordinates) {
  for (const bool is_float : {true, false}) {
    for (const double far : {5.6e6, 0.0}) {
      Scan scan = cloud_scan(random_sphere(2000, 10.0));
      for (Eigen::Vector3d& p : scan.positions) {
        p.x() += far;
        for (double& value : p) {
          value = is_float ? static_cast<double>(static_cast<float>(value)) : value;
        }
      }
      const Cleaned cleaned = clean_one(std::move(scan), {});
      ASSERT_EQ(cleaned.report.warnings.size(), is_float && far > 0.0 ? 1U : 0U);
      if (is_float && far > 0.0) {
        EXPECT_NE(cleaned.report.warnings[0].find("steps of 500 mm"), std::string::npos);
      }
    }
  }
}

TEST(Cleaning, CropsInSourceUnits) {
  BuildOptions options;
  options.unit_m = 0.001;
  options.up = UpAxis::kY;
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(-20, -20, 0), Eigen::Vector3d(20, 20, 20));
  const Cleaned cloud = clean_one(cloud_scan(random_sphere(2000, 10.0)), options);
  EXPECT_EQ(cloud.report.kept_points + cloud.report.dropped.at("outside_crop"), 2000U);
  EXPECT_NEAR(static_cast<double>(cloud.report.kept_points), 1000.0, 100.0);
  for (const Eigen::Vector3d& p : cloud.input.points.positions()) {
    ASSERT_GE(p.x(), 0.0);  // the source's +z is the model's +x
  }
  const Cleaned mesh = clean_one(mesh_scan(box_mesh({-30, -30, -30}, {10, 10, 10})), options);
  EXPECT_NEAR(mesh.input.bounds.sizes().x(), 0.010, 1e-12);
  EXPECT_NEAR(mesh.input.bounds.sizes().y(), 0.030, 1e-12);
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(90, 90, 90), Eigen::Vector3d(99, 99, 99));
  EXPECT_THROW((void)clean_one(cloud_scan(random_sphere(2000, 10.0)), options), std::runtime_error);
}

TEST(Cleaning, CropsTurnedModelInSourceAxes) {
  BuildOptions options;
  options.turn_deg = 45.0;
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 1));
  const Cleaned mesh = clean_one(mesh_scan(box_mesh({-3, -3, -3}, {1, 1, 1})), options);
  // The corner of the box in the crop: a cube with an edge of 2, on its edge.
  EXPECT_NEAR(mesh.input.bounds.sizes().x(), 2.0 * std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(mesh.input.bounds.sizes().z(), 2.0, 1e-12);
  EXPECT_TRUE(mesh.input.crop.contains({1.3, 0.0, 0.0}));
  EXPECT_FALSE(mesh.input.crop.contains({0.9, 0.9, 0.0}));
  options.fit_m = 0.1;
  const Cleaned fitted = clean_one(mesh_scan(box_mesh({-3, -3, -3}, {1, 1, 1})), options);
  EXPECT_NEAR(fitted.input.bounds.sizes().x(), 0.1, 1e-12);
  EXPECT_TRUE(fitted.input.crop.contains({0.049, 0.0, 0.0}));
  EXPECT_FALSE(fitted.input.crop.contains({0.03, 0.03, 0.0}));
}

TEST(Cleaning, CountsEveryDroppedPoint) {
  Cloud cloud = even_sphere(3000, 0.1);
  cloud.positions[7].x() = std::numeric_limits<double>::quiet_NaN();
  cloud.positions[8].z() = std::numeric_limits<double>::infinity();
  cloud.positions.push_back(cloud.positions[20]);
  cloud.positions.emplace_back(3.0e4, -1.0e5, 0.0);
  cloud.positions.emplace_back(0.0, 0.5, 0.0);
  cloud.normals.resize(cloud.size(), Eigen::Vector3f::UnitX());
  Scan scan = cloud_scan(std::move(cloud));
  scan.dropped["non_finite"] = 5;  // by the reader
  scan.dropped["bad_row"] = 2;
  const Cleaned cleaned = clean_one(std::move(scan));
  const std::map<std::string, std::uint64_t> expected = {
      {"non_finite", 7}, {"bad_row", 2}, {"duplicate", 1}, {"outlier", 2}};
  EXPECT_EQ(cleaned.report.dropped, expected);
  EXPECT_EQ(cleaned.report.input_points, 3010U);
  EXPECT_EQ(cleaned.report.kept_points, 2998U);
  EXPECT_NEAR(cleaned.input.bounds.sizes().maxCoeff(), 0.2, 0.001);
}

TEST(Cleaning, OutliersLeaveEstimatesUnchanged) {
  const Cleaned clean_cloud = clean_one(cloud_scan(random_sphere(20000, 0.1)));
  for (const double far : {0.4, 1.0, 30.0, 1e5}) {
    Cloud strayed = random_sphere(20000, 0.1);
    for (int k = 0; k < 10; ++k) {
      strayed.positions.emplace_back(far * (1.0 + 0.3 * k), far * (k % 3 - 1.0), -far * k);
      strayed.normals.push_back(Eigen::Vector3f::UnitX());
    }
    const Cleaned cleaned = clean_one(cloud_scan(std::move(strayed)));
    EXPECT_EQ(cleaned.report.dropped.at("outlier"), 10U) << far;
    EXPECT_NEAR(cleaned.input.points_spacing, clean_cloud.input.points_spacing,
                0.01 * clean_cloud.input.points_spacing);
    EXPECT_NEAR(cleaned.input.bounds.sizes().x(), clean_cloud.input.bounds.sizes().x(), 1e-12);
  }
}

TEST(Cleaning, KeepsOutliersOnRequest) {
  Cloud cloud = random_sphere(2000, 0.1);
  cloud.positions.emplace_back(50.0, 0.0, 0.0);
  cloud.normals.push_back(Eigen::Vector3f::UnitX());
  BuildOptions options;
  options.outlier_sigma = 0.0;
  EXPECT_EQ(clean_one(cloud_scan(std::move(cloud)), options).report.kept_points, 2001U);
}

TEST(Cleaning, NormalisesAndValidatesNormals) {
  Cloud cloud = even_sphere(1000, 0.1);
  cloud.normals[1] *= 7.0F;
  cloud.normals[2].setZero();
  cloud.normals[3].x() = std::numeric_limits<float>::quiet_NaN();
  const Cleaned cleaned = clean_one(cloud_scan(std::move(cloud)));
  std::size_t unknown = 0;
  for (const Eigen::Vector3f& normal : cleaned.input.points.normals()) {
    unknown += normal.isZero() ? 1U : 0U;
    ASSERT_TRUE(normal.isZero() || std::abs(normal.norm() - 1.0F) < 1e-6F);
  }
  EXPECT_EQ(unknown, 2U);
}

TEST(Cleaning, DropsUnusedAndOutlyingCorners) {
  Mesh mesh = box_mesh({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
  mesh.positions.emplace_back(1.0, 1.0, 1.0);    // not used by a face
  mesh.positions.emplace_back(1.0e5, 0.0, 0.0);  // an outlier
  mesh.triangles.push_back({0, 1, 9});
  const Cleaned cleaned = clean_one(mesh_scan(std::move(mesh)));
  EXPECT_EQ(cleaned.report.dropped.at("not_in_a_face"), 1U);
  EXPECT_EQ(cleaned.report.dropped.at("outlier"), 1U);
  EXPECT_EQ(cleaned.report.dropped.at("outlier_face"), 1U);
  EXPECT_EQ(cleaned.report.kept_points, 8U);
  EXPECT_NEAR(cleaned.input.bounds.sizes().x(), 0.2, 1e-12);
}

TEST(Cleaning, WarnsOfManyVerticesInNoFace) {
  const auto warnings_with = [](std::uint32_t boxes, std::size_t unused) {
    Mesh mesh;
    const Mesh box = box_mesh({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
    for (std::uint32_t i = 0; i < boxes; ++i) {  // of 8 vertices, beside each other
      for (const Eigen::Vector3d& p : box.positions) {
        mesh.positions.push_back(p + Eigen::Vector3d(0.3 * i, 0, 0));
      }
      for (const auto& [a, b, c] : box.triangles) {
        mesh.triangles.push_back({8 * i + a, 8 * i + b, 8 * i + c});
      }
    }
    for (std::size_t i = 0; i < unused; ++i)
      mesh.positions.emplace_back(0.1 * static_cast<double>(i), 1, 0);
    return clean_one(mesh_scan(std::move(mesh))).report.warnings;
  };
  EXPECT_TRUE(warnings_with(10, 100).empty());   // few
  EXPECT_TRUE(warnings_with(125, 110).empty());  // a small part
  const std::vector<std::string> warnings = warnings_with(125, 112);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("112 of 1112 vertices"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("file of their own"), std::string::npos);
}

TEST(Cleaning, JoinsScansDespiteMissingNormals) {
  std::vector<Scan> scans;
  scans.push_back(cloud_scan(without_normals(even_sphere(500, 0.1))));
  scans.push_back(cloud_scan(even_sphere(700, 0.11)));
  scans.push_back(mesh_scan(box_mesh({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2})));
  BuildReport report;
  const CleanInput input = clean(std::move(scans), {}, report);
  EXPECT_EQ(input.points.size(), 1200U);
  EXPECT_EQ(input.mesh.triangles.size(), 12U);
  EXPECT_NEAR(input.bounds.sizes().x(), 0.4, 1e-12);
  std::size_t known = 0;
  for (const Eigen::Vector3f& normal : input.points.normals()) {
    known += normal.isZero() ? 0U : 1U;
  }
  EXPECT_EQ(known, 700U);
}

}  // namespace
}  // namespace tactree::builder
