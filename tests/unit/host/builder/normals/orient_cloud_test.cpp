// The side of the normals of clouds whose true normals are known.

#include <gtest/gtest.h>

#include <algorithm>

#include "known_bodies.hpp"
#include "normals/report_orientation.hpp"
#include "orientation_score.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

using bench::KnownCloud;
constexpr std::size_t kBodyPoints = 8000;

BuildResult built_from(const Scan& scan, BuildOptions options = {}) {
  Progress quiet;
  options.name = "body";
  return build_model({scan}, options, quiet);
}

double wrong(const KnownCloud& cloud) {
  return bench::wrong_share(cloud, built_from(bench::scan_of(cloud)));
}

bool warns(const BuildResult& built, const std::string& text) {
  return std::any_of(
      built.report.warnings.begin(), built.report.warnings.end(),
      [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

TEST(Orientation, FacesOutwardOnClosedBodies) {
  for (const std::uint64_t turn : {0U, 1U}) {
    for (KnownCloud cloud :
         {bench::twisted_arms(kBodyPoints, 3.0, 1), bench::long_blade(kBodyPoints, 2.5, 1),
          bench::thin_gear(kBodyPoints, 2.5, 1), bench::torus_knot(kBodyPoints, 5.0, 1),
          bench::vessel(kBodyPoints, 3.0, 1)}) {
      bench::rotate(cloud, turn);
      EXPECT_LE(wrong(cloud), 0.005) << cloud.name;
    }
    KnownCloud ears = bench::head_with_ears(kBodyPoints, 3.0, 1);
    bench::rotate(ears, turn);
    EXPECT_LE(wrong(ears), 0.03);
  }
}

TEST(Orientation, SurvivesNoise) {
  for (KnownCloud cloud :
       {bench::long_blade(kBodyPoints, 4.0, 1), bench::torus_knot(kBodyPoints, 6.0, 1)}) {
    bench::add_noise(cloud, 0.35, 1);
    EXPECT_LE(wrong(cloud), 0.01) << cloud.name;
  }
}

TEST(Orientation, PointsIntoHollows) {
  EXPECT_LE(wrong(bench::nested_shells(kBodyPoints, 1)), 0.005);
}

TEST(Orientation, FacesOutwardOnOpenFigure) {
  EXPECT_LE(wrong(bench::open_figure(kBodyPoints, 1)), 0.005);
  EXPECT_LE(wrong(bench::merged_views(bench::open_figure(2 * kBodyPoints, 1), 10, 0.5, 1)), 0.03);
}

TEST(Orientation, FacesUpOnDoubtfulSheet) {
  const KnownCloud relief = bench::open_relief(kBodyPoints, 1);
  const BuildResult built = built_from(bench::scan_of(relief));
  EXPECT_LE(bench::wrong_share(relief, built), 0.005);
  EXPECT_TRUE(warns(built, "ambiguous"));
  EXPECT_EQ(built.report.orientation.doubtful_points, built.report.output_points);
}

TEST(Orientation, FollowsViewpointOnTurnedTerrain) {
  KnownCloud terrain = bench::open_relief(kBodyPoints, 1);
  for (std::size_t i = 0; i < terrain.positions.size(); ++i) {  // y up
    for (Eigen::Vector3d* v : {&terrain.positions[i], &terrain.normals[i]}) {
      *v = Eigen::Vector3d(v->x(), v->z(), -v->y());
    }
  }
  EXPECT_LE(wrong(terrain), 0.005);
  BuildOptions options;
  options.viewpoints = {{0.0, -0.5, 0.0}};
  const BuildResult seen = built_from(bench::scan_of(terrain), options);
  EXPECT_GE(bench::wrong_share(terrain, seen), 0.995);
  EXPECT_FALSE(warns(seen, "ambiguous"));
  EXPECT_EQ(seen.report.orientation.pieces[0].basis, OrientationBasis::kViewpoint);
}

TEST(Orientation, FacesGivenViewpoint) {
  const Eigen::Vector3d camera(150.0, 90.0, 60.0);
  const KnownCloud view = bench::seen_from(bench::head_with_ears(2 * kBodyPoints, 6.0, 1), camera);
  BuildOptions options;
  options.viewpoints = {bench::kUnit_m * camera};
  EXPECT_LE(bench::wrong_share(view, built_from(bench::scan_of(view), options)), 0.005);
}

/// A valley of a relief, seen from above by a scanner that tilts it.
struct SeenValley {
  KnownCloud cloud = bench::open_relief(kBodyPoints, 1);
  Scan scan;
  explicit SeenValley(double height) {
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {  // upside down: -z is seen
      for (Eigen::Vector3d* v : {&cloud.positions[i], &cloud.normals[i]}) {
        *v = Eigen::Vector3d(v->x(), -v->y(), -v->z());
      }
    }
    scan = bench::scan_of(cloud);
    scan.poses = {{Eigen::Vector3d(0.0, 0.0, height), 0, true}};
  }
};

TEST(Orientation, FacesPoseInFile) {
  const SeenValley below(-0.5);
  const BuildResult built = built_from(below.scan);
  EXPECT_LE(bench::wrong_share(below.cloud, built), 0.005);
  EXPECT_FALSE(warns(built, "ambiguous"));
  EXPECT_EQ(built.report.orientation.pieces[0].basis, OrientationBasis::kViewpoint);
  BuildOptions by_pose;
  by_pose.orient = OrientationRule::kViewpoint;
  EXPECT_LE(bench::wrong_share(below.cloud, built_from(below.scan, by_pose)), 0.005);
}

TEST(Orientation, UserViewpointOverridesFilePose) {
  BuildOptions options;
  options.viewpoints = {{0.0, 0.0, 0.5}};
  const SeenValley below(-0.5);
  EXPECT_GE(bench::wrong_share(below.cloud, built_from(below.scan, options)), 0.995);
  options = {};
  options.orient = OrientationRule::kUp;
  EXPECT_GE(bench::wrong_share(below.cloud, built_from(below.scan, options)), 0.995);
}

TEST(Orientation, IgnoresHalfHiddenPose) {
  const KnownCloud body = bench::torus_knot(kBodyPoints, 6.0, 1);
  for (const bool sure : {true, false}) {
    Scan scan = bench::scan_of(body);
    scan.poses = {{Eigen::Vector3d(0.3, 0.1, 0.1), 0, sure}};
    const BuildResult built = built_from(scan);
    EXPECT_LE(bench::wrong_share(body, built), 0.005) << sure;
    EXPECT_EQ(warns(built, "hidden from there"), sure);
  }
}

TEST(Orientation, IgnoresDefaultPoseInsideBody) {
  const KnownCloud body = bench::nested_shells(kBodyPoints, 1);
  Scan scan = bench::scan_of(body);
  scan.poses = {{Eigen::Vector3d::Zero(), 0, false}};
  EXPECT_LE(bench::wrong_share(body, built_from(scan)), 0.005);
}

TEST(Orientation, DoubtsSheetSeenEdgeOn) {
  Scan scan = cloud_scan(plane_grid(60, 1e-3));
  for (const bool sure : {true, false}) {
    scan.poses = {{Eigen::Vector3d(0.5, 0.03, 0.0), 0, sure}};
    EXPECT_TRUE(warns(built_from(scan), "ambiguous")) << sure;
  }
}

/// The notes and the basis of the largest piece must not contradict each other.
TEST(Orientation, NotesScannerOnlyIfDecisive) {
  const auto says = [](const BuildResult& built, const char* what) {
    const std::vector<std::string>& notes = built.report.notes;
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
      return note.find(what) != std::string::npos;
    });
  };
  const BuildResult seen = built_from(SeenValley(-0.5).scan);
  EXPECT_TRUE(says(seen, "the surface faces the scanner at (0, 0, -0.5)"));
  EXPECT_FALSE(says(seen, "determines no orientation"));
  Scan scan = cloud_scan(plane_grid(12, 5e-3));
  scan.poses = {{Eigen::Vector3d(0.5, 0.03, 0.0), 0, true}};
  const BuildResult edge_on = built_from(scan);
  ASSERT_EQ(edge_on.report.orientation.pieces.at(0).basis, OrientationBasis::kUp);
  EXPECT_FALSE(says(edge_on, "faces the scanner"));
  EXPECT_TRUE(says(edge_on, "(0.5, 0.03, 0), determines no orientation"));
}

TEST(Orientation, AsksForMissingViewpointOnly) {
  for (const OrientationBasis basis : {OrientationBasis::kViewpoint, OrientationBasis::kOutside}) {
    CloudOrientation found;
    found.pieces = {{1000, Eigen::Vector3d::Zero(), basis, 0.5}};
    BuildResult built;
    report_orientation(found, 0, built.report);
    EXPECT_TRUE(warns(built, "ambiguous"));
    EXPECT_EQ(warns(built, "give --viewpoint"), basis == OrientationBasis::kOutside);
  }
}

TEST(Orientation, StatesShareFacingScanner) {
  CloudOrientation found;
  found.pieces = {{800, Eigen::Vector3d::Zero(), OrientationBasis::kViewpoint, 1.0},
                  {200, Eigen::Vector3d::Zero(), OrientationBasis::kOutside, 1.0}};
  BuildReport report;
  report.orientation.scanners = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  report_orientation(found, 0, report);
  ASSERT_EQ(report.notes.size(), 1U);
  EXPECT_EQ(report.notes[0],
            "80 % of the surface faces the scanner at (1, 2, 3) and 1 more position, as the file "
            "states (--orient outward ignores it)");
}

TEST(Orientation, IgnoresFarDefaultPose) {
  Scan scan = cloud_scan(cosine_sheet(60, 0.06, 1e-3, 100.0));
  for (Eigen::Vector3d& p : scan.positions) {
    p += Eigen::Vector3d(500.0, 5600.0, 30.0);
  }
  scan.poses = {{Eigen::Vector3d::Zero(), 0, false}};
  EXPECT_NE(built_from(scan).report.orientation.pieces.at(0).basis, OrientationBasis::kViewpoint);
}

TEST(Orientation, FacesEachScannerPose) {
  const KnownCloud body = bench::head_with_ears(2 * kBodyPoints, 6.0, 1);
  KnownCloud merged;
  Scan scan;
  for (const Eigen::Vector3d& camera :
       {Eigen::Vector3d(150.0, 90.0, 60.0), Eigen::Vector3d(-150.0, 60.0, -60.0)}) {
    const KnownCloud view = bench::seen_from(body, camera);
    scan.poses.push_back({bench::kUnit_m * camera, merged.positions.size(), true});
    merged.positions.insert(merged.positions.end(), view.positions.begin(), view.positions.end());
    merged.normals.insert(merged.normals.end(), view.normals.begin(), view.normals.end());
  }
  const std::vector<ScannerPose> poses = std::move(scan.poses);
  scan = bench::scan_of(merged);
  scan.poses = poses;
  EXPECT_LE(bench::wrong_share(merged, built_from(scan)), 0.005);
}

TEST(Orientation, DoubtsVeryThinPlate) {
  KnownCloud plate = bench::flat_plate(kBodyPoints, 1.0, 1);
  bench::add_noise(plate, 0.2, 1);
  const BuildResult built = built_from(bench::scan_of(plate));
  EXPECT_GT(bench::wrong_share(plate, built), 0.05);
  EXPECT_GE(static_cast<double>(built.report.orientation.doubtful_points),
            0.9 * static_cast<double>(built.report.output_points));
  EXPECT_TRUE(warns(built, "--viewpoint"));
}

TEST(Orientation, RepairsWrongFileNormals) {
  const KnownCloud body = bench::torus_knot(kBodyPoints, 6.0, 1);
  for (const double inward : {0.0, 0.5, 1.0}) {
    Scan scan = bench::scan_of(body);
    for (std::size_t i = 0; i < body.normals.size(); ++i) {
      const Eigen::Vector3f normal = body.normals[i].cast<float>();
      scan.normals.push_back(unit_random(i) < inward ? Eigen::Vector3f(-normal) : normal);
    }
    const BuildResult built = built_from(scan);
    EXPECT_LE(bench::wrong_share(body, built), 0.005) << inward;
    EXPECT_EQ(warns(built, "normals of the file"), inward > 0.0);
    EXPECT_EQ(built.report.orientation.reversed_normals > 0, inward == 1.0);
    BuildOptions given;
    given.orient = OrientationRule::kGiven;
    EXPECT_NEAR(bench::wrong_share(body, built_from(scan, given)), inward, 0.03);
  }
}

TEST(Orientation, RefusesRuleWithoutViewpoint) {
  BuildOptions options;
  options.orient = OrientationRule::kViewpoint;
  EXPECT_THROW((void)built_from(bench::scan_of(bench::open_relief(1000, 1)), options), BuildError);
}

}  // namespace
}  // namespace tactree::builder
