#include "tactree/builder/build_model.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "folder_test.hpp"
#include "shapes.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {
namespace {

Scan box_scan(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return mesh_scan(box_mesh(low, high));
}

BuildResult build(Scan scan, const BuildOptions& options = {}) {
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  Progress quiet;
  return build_model(std::move(scans), options, quiet);
}

struct DecodedPoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;
};

std::vector<DecodedPoint> decode(const BuildResult& result) {
  core::BlobView view;
  EXPECT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  std::vector<DecodedPoint> points;
  const auto wide = [](core::Vec3 v) {
    return Eigen::Vector3d(static_cast<double>(v.x), static_cast<double>(v.y),
                           static_cast<double>(v.z));
  };
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {
      const core::SurfacePoint p = view.surface_point(leaf, leaf.first_point + i);
      points.push_back({wide(p.position), wide(p.normal)});
    }
  }
  return points;
}

TEST(BuildModel, KeepsPointsOnSphere) {
  const double radius = 0.03;
  for (const bool with_normals : {true, false}) {
    Cloud cloud = random_sphere(100000, radius);
    if (!with_normals) {
      cloud.normals.clear();
    }
    BuildOptions options;
    options.spacing_m = 0.001;
    const BuildResult result = build(cloud_scan(std::move(cloud)), options);
    const std::vector<DecodedPoint> points = decode(result);
    EXPECT_EQ(points.size(), result.report.output_points);
    EXPECT_NEAR(static_cast<double>(points.size()), 0.83 * 11310.0,
                300.0);  // 9 candidates per square
    for (const DecodedPoint& p : points) {
      ASSERT_LT(std::abs(p.position.norm() - radius), 0.02 * 0.001);
      ASSERT_GT(p.normal.dot(p.position.normalized()), 0.998);
    }
    EXPECT_TRUE(result.report.openings.empty());
    EXPECT_LT(result.report.largest_gap_m, 0.0025);
  }
}

TEST(BuildModel, KeepsPointsOnBoxFaces) {
  const Eigen::Vector3d low(-0.03, -0.02, -0.01);
  const Eigen::Vector3d high(0.03, 0.02, 0.01);
  BuildOptions options;
  options.spacing_m = 0.001;
  const BuildResult result = build(box_scan(low, high), options);
  const Box box(low, high);
  std::size_t off_their_face = 0;
  for (const DecodedPoint& p : decode(result)) {
    ASSERT_LT(std::abs(box.exteriorDistance(p.position)), 0.02 * 0.001);
    const Eigen::Vector3d face = box_face_at(p.position, low, high, 0.02 * 0.001);
    off_their_face += face.isZero() || p.normal.dot(face) < 0.9999 ? 1U : 0U;
  }
  EXPECT_LT(off_their_face, 30U);  // within 2 % of the spacing of an edge
}

TEST(BuildModel, IsIndependentOfThreads) {
  for (const bool mesh : {false, true}) {
    BuildOptions options;
    std::vector<std::byte> bytes[3];
    for (unsigned threads = 1; threads <= 3; ++threads) {
      options.threads = threads;
      options.name = "same";
      bytes[threads - 1] = build(mesh ? box_scan({0, 0, 0}, {0.05, 0.03, 0.02})
                                      : cloud_scan(without_normals(random_sphere(40000, 0.03))),
                                 options)
                               .blob.bytes;
    }
    EXPECT_EQ(bytes[0], bytes[1]);
    EXPECT_EQ(bytes[0], bytes[2]);
  }
}

TEST(BuildModel, KeepsBallsWithinBoardLimit) {
  BuildOptions options;
  options.resample = false;  // many more points than for the spacing
  Cloud cloud = even_sphere(1000, 0.03);
  const Cloud dense = random_sphere(60000, 0.03);
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (dense.positions[i].z() > 0.025) {
      cloud.positions.push_back(dense.positions[i]);
      cloud.normals.push_back(dense.normals[i]);
    }
  }
  options.spacing_m = 0.004;
  const BuildResult result = build(cloud_scan(std::move(cloud)), options);
  EXPECT_GT(result.report.thinned, 0U);
  core::BlobView view;
  ASSERT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  EXPECT_LE(view.header().points_per_ball_max, 128U);
  EXPECT_GT(view.header().points_per_ball_max, 64U);
}

TEST(BuildModel, KeepsBodyWithinFlashBudget) {
  const Scan body = box_scan({-0.03, -0.02, -0.01}, {0.03, 0.02, 0.01});
  for (const std::uint64_t budget : {13000U, 20000U, 60000U}) {
    BuildOptions options;
    options.flash_budget_bytes = budget;
    for (const bool mesh : {true, false}) {
      const BuildResult result =
          build(mesh ? body : cloud_scan(random_sphere(50000, 0.03)), options);
      EXPECT_GT(result.report.backed_share, 0.9);
      EXPECT_LE(result.report.bytes, budget);
      EXPECT_GE(result.report.bytes, budget * 85 / 100);
      const std::string size = fmt::format(": {} bytes, ", result.report.bytes);
      const std::vector<std::string>& notes = result.report.notes;
      EXPECT_EQ(std::count_if(notes.begin(), notes.end(),
                              [&](const std::string& note) {
                                return note.starts_with("the flash budget of ") &&
                                       note.find(size) != std::string::npos;
                              }),
                1)
          << fmt::format("{}", fmt::join(notes, "\n"));
    }
  }
}

TEST(BuildModel, KeepsTurnedBodyWithinFlashBudget) {
  BuildOptions options;
  for (const std::uint64_t budget : {8000U, 16000U}) {
    options.flash_budget_bytes = budget;
    for (const double turn : {0.0, 0.4, 0.8, 1.2}) {
      options.pose =
          Eigen::Isometry3d(Eigen::AngleAxisd(turn, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
      const BuildResult result =
          build(box_scan({-0.03, -0.02, -0.01}, {0.03, 0.02, 0.01}), options);
      EXPECT_LE(result.report.bytes, budget);
      EXPECT_GE(result.report.bytes, budget * 85 / 100);
    }
  }
}

TEST(BuildModel, TellsThatBudgetAllowsMoreThanScan) {
  BuildOptions options;
  options.flash_budget_bytes = 10'000'000;
  const std::vector<std::string> notes =
      build(cloud_scan(plane_grid(100, 0.0025)), options).report.notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.ends_with("; the scan has no finer detail");
  }));
}

TEST(BuildModel, BuildsTinyInputs) {
  const std::vector<Eigen::Vector3d> corners = box_mesh({0, 0, 0}, {0.1, 0.1, 0.1}).positions;
  for (std::size_t n = 1; n <= 8; ++n) {
    Scan scan;
    scan.positions.assign(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(n));
    const BuildResult result = build(std::move(scan));
    EXPECT_EQ(result.report.output_points, n);
    EXPECT_FALSE(result.report.warnings.empty());
  }
}

TEST(BuildModel, RecordsSourceAndTool) {
  Cloud cloud = random_sphere(5000, 40.0);
  for (Eigen::Vector3d& p : cloud.positions) {
    p += Eigen::Vector3d(1000.0, 2000.0, 3000.0);
  }
  BuildOptions options;
  options.unit_m = 0.001;
  options.name = "ball";
  const BuildResult result = build(cloud_scan(std::move(cloud)), options);
  EXPECT_NEAR(result.report.source_origin.z(), 3000.0, 1.0);
  EXPECT_EQ(result.report.source_scale, 0.001);
  EXPECT_LT(result.report.bounds.center().norm(), 1e-4);
  core::BlobView view;
  ASSERT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  EXPECT_STREQ(view.header().name, "ball");
}

TEST(BuildModel, PoseIsAppliedLastToSamePoints) {
  Cloud cloud = random_sphere(20000, 0.03);
  for (Eigen::Vector3d& p : cloud.positions) {
    p.x() *= 1.5;
    p += Eigen::Vector3d(0.6, 0.0, 0.0);  // far from the origin, which the builder moves
  }
  BuildOptions options;
  options.turn_deg = 30.0;
  const BuildResult plain = build(cloud_scan(without_normals(cloud)), options);
  options.placed_scale = 0.5;
  options.pose = Eigen::Isometry3d::Identity();
  options.pose->linear() =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  options.pose->translation() = Eigen::Vector3d(0.05, -0.02, 0.01);
  const BuildResult placed = build(cloud_scan(without_normals(cloud)), options);
  ASSERT_EQ(placed.report.output_points, plain.report.output_points);
  EXPECT_NEAR(placed.report.spacing_m, 0.5 * plain.report.spacing_m, 1e-12);
  EXPECT_NEAR(placed.report.source_scale, 0.5 * plain.report.source_scale, 1e-15);
  const Eigen::Vector3d centre = *options.pose * (0.5 * plain.report.orientation.pieces[0].centre);
  EXPECT_LT((placed.report.orientation.pieces[0].centre - centre).norm(), 1e-9);

  std::vector<DecodedPoint> wanted = decode(plain);
  for (DecodedPoint& point : wanted) {
    point.position = *options.pose * (0.5 * point.position);
    point.normal = options.pose->linear() * point.normal;
  }
  for (const DecodedPoint& point : decode(placed)) {
    const auto nearest = std::min_element(
        wanted.begin(), wanted.end(), [&](const DecodedPoint& a, const DecodedPoint& b) {
          return (a.position - point.position).norm() < (b.position - point.position).norm();
        });
    ASSERT_LT((nearest->position - point.position).norm(), 0.05 * placed.report.spacing_m);
    ASSERT_GT(nearest->normal.dot(point.normal), 0.999);
  }
}

TEST(BuildModel, ReportsColoursWithoutMaterials) {
  Scan scan = cloud_scan(random_sphere(1000, 0.03));
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    scan.colours.push_back(i < 700 ? Colour{250, 10, 5} : Colour{120, 120, 120});
  }
  const BuildReport report = build(std::move(scan)).report;
  ASSERT_EQ(report.colours.size(), 2U);
  EXPECT_EQ(report.colours[0].colour, (Colour{250, 10, 5}));
  EXPECT_EQ(report.colours[0].points, 700U);
  EXPECT_TRUE(report.colour_matches.empty());
}

TEST(BuildModel, KeepsColoursOfPointsOnDemand) {
  Scan scan = cloud_scan(random_sphere(60000, 0.03));
  for (const Eigen::Vector3d& position : scan.positions) {
    scan.colours.push_back(position.z() > 0.0 ? Colour{250, 10, 5} : Colour{20, 30, 240});
  }
  BuildOptions options;
  options.spacing_m = 1e-3;
  EXPECT_TRUE(build(scan, options).colours.empty());
  options.keep_colours = KeepColours::kIfAny;
  const BuildResult result = build(scan, options);
  core::BlobView view;
  ASSERT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  ASSERT_EQ(result.colours.size(), view.point_count());
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const float z = view.position(leaf, index).z;
    if (std::abs(z) > 1e-5F) {  // not on the border
      ASSERT_EQ(result.colours[index], z > 0.0F ? (Colour{250, 10, 5}) : (Colour{20, 30, 240}));
    }
  });
}

TEST(BuildModel, RequiresColoursOnDemand) {
  const Scan scan = cloud_scan(random_sphere(1000, 0.03));
  BuildOptions options;
  options.keep_colours = KeepColours::kIfAny;
  EXPECT_TRUE(build(scan, options).colours.empty());
  options.keep_colours = KeepColours::kRequire;
  EXPECT_THROW((void)build(scan, options), BuildError);
}

TEST(BuildModel, ScanWithoutColoursGetsNeutralOne) {
  const Colour red = {250, 10, 5};
  std::vector<Scan> scans;
  for (const double x : {-0.05, 0.05}) {
    Scan& scan = scans.emplace_back(cloud_scan(random_sphere(20000, 0.03)));
    for (Eigen::Vector3d& position : scan.positions) {
      position.x() += x;
    }
  }
  scans[0].colours.assign(scans[0].positions.size(), red);
  BuildOptions options;
  options.spacing_m = 1e-3;
  options.keep_colours = KeepColours::kRequire;
  Progress quiet;
  const BuildResult result = build_model(std::move(scans), options, quiet);
  const std::vector<DecodedPoint> points = decode(result);
  ASSERT_EQ(result.colours.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(result.colours[i], points[i].position.x() < 0.0 ? red : kNoColour);
  }
}

TEST(BuildModel, BothSidesOfSheetHaveItsColours) {
  const Colour red = {250, 10, 5};
  const Colour blue = {20, 30, 240};
  Scan scan;
  for (const Eigen::Vector3d& position : random_sphere(40000, 0.03).positions) {
    if (position.z() > 0.0) {
      scan.positions.push_back(position);
      scan.colours.push_back(position.x() > 0.0 ? red : blue);
    }
  }
  BuildOptions options;
  options.spacing_m = 1e-3;
  options.keep_colours = KeepColours::kRequire;
  options.two_sided_m = 3e-3;
  const BuildResult result = build(std::move(scan), options);
  const std::vector<DecodedPoint> points = decode(result);
  ASSERT_EQ(result.colours.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].position.x();
    if (std::abs(x) > 3e-3) {  // not on the border, from which the thickness moves points
      ASSERT_EQ(result.colours[i], x > 0.0 ? red : blue);
    }
  }
}

TEST(BuildModel, SourceOriginIsThatOfPlacedFrame) {
  BuildOptions options;
  options.unit_m = 0.001;
  options.up = UpAxis::kY;  // y -> z, z -> x, x -> y
  options.pose = Eigen::Isometry3d::Identity();
  options.pose->translation() = Eigen::Vector3d(0.01, 0.02, 0.03);
  const BuildResult result = build(cloud_scan(random_sphere(5000, 30.0)), options);
  const Eigen::Vector3d origin(-20.0, -30.0, -10.0);
  EXPECT_LT((result.report.source_origin - origin).norm(), 1e-9)
      << result.report.source_origin.transpose();
}

TEST(BuildModel, RefusesEmptyInputs) {
  EXPECT_THROW((void)build(Scan()), BuildError);
  Progress quiet;
  EXPECT_THROW((void)build_model(std::span<const std::filesystem::path>(), {}, quiet), BuildError);
}

class BuildFromFiles : public test::FolderTest {
 protected:
  std::filesystem::path write(const std::string& name, const Cloud& cloud) {
    std::ofstream out(folder_ / name);
    out.precision(17);
    for (const Eigen::Vector3d& p : cloud.positions) {
      out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
    return folder_ / name;
  }

  /// A plane: one point for each x in [first, last) and y in [0, 50).
  std::filesystem::path write_grid(const std::string& name, int first, int last) {
    std::ofstream out(folder_ / name);
    for (int x = first; x < last; ++x) {
      for (int y = 0; y < 50; ++y) {
        out << x << ' ' << y << " 0\n";
      }
    }
    return folder_ / name;
  }
};

TEST_F(BuildFromFiles, JoinsFilesAndDigestsBytes) {
  const std::vector<std::filesystem::path> files = {write_grid("one.xyz", 0, 50),
                                                    write_grid("two.xyz", 50, 90)};
  BuildOptions options;
  options.unit_m = 0.001;
  Progress quiet;
  const BuildResult result = build_model(files, options, quiet);
  EXPECT_EQ(result.report.input_points, 4500U);
  ASSERT_EQ(result.report.inputs.size(), 2U);
  EXPECT_EQ(result.report.inputs[1].points, 2000U);
  core::BlobView view;
  ASSERT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  EXPECT_STREQ(view.header().name, "one");
  std::string digest;
  for (const std::uint8_t byte : view.header().source_digest) {
    digest += fmt::format("{:02x}", byte);
  }
  // cat one.xyz two.xyz | sha256sum
  EXPECT_EQ(digest, "9e43bc9680612ba195ee465d409d9192d5c12348abbd9d77de6b5cf973b71774");
}

TEST_F(BuildFromFiles, NamesUnbuildableFile) {
  const std::vector<std::filesystem::path> files = {write("ball.xyz", even_sphere(2000, 0.03))};
  BuildOptions options;
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(2, 2, 2));
  Progress quiet;
  try {
    (void)build_model(files, options, quiet);
    FAIL() << "a cropped-away scan was built";
  } catch (const BuildError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(files[0].string() + ": ", 0), 0U) << error.what();
    EXPECT_NE(std::string(error.what()).find("2000 outside_crop"), std::string::npos);
  }
}

TEST(BuildModel, WarnsOfImplausibleSize) {
  const auto warned = [](double radius_m, const BuildOptions& options) {
    Progress quiet;
    const BuildReport report =
        build_model({cloud_scan(random_sphere(2000, radius_m))}, options, quiet).report;
    return std::any_of(report.warnings.begin(), report.warnings.end(), [](const std::string& w) {
      return w.find("--unit") != std::string::npos && w.find("reaches") != std::string::npos;
    });
  };
  EXPECT_FALSE(warned(0.45, {}));
  EXPECT_TRUE(warned(0.55, {}));
  EXPECT_FALSE(warned(0.0026, {}));
  EXPECT_TRUE(warned(0.0024, {}));
  BuildOptions options;
  options.unit_m = 1.0;
  EXPECT_FALSE(warned(0.55, options));
  options.unit_m.reset();
  options.fit_m = 0.1;
  EXPECT_FALSE(warned(0.55, options));
}

}  // namespace
}  // namespace tactree::builder
