// Clouds with more points than wanted are thinned while they are read.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>
#include <vector>

#include "e57_writer.hpp"
#include "grid_thinning.hpp"
#include "las_writer.hpp"
#include "scan_builder.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using namespace tactree::test;

/// Points of a sphere; coordinates that all formats represent exactly.
std::vector<Vector3i> ball(int count, int radius = 2000) {
  std::vector<Vector3i> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    const Vector3d p = radius * Vector3d(r * std::cos(angle), r * std::sin(angle), z);
    points.emplace_back(p.array().round().cast<int>());
  }
  return points;
}

std::vector<Vector3d> exact(const std::vector<Vector3i>& points) {
  std::vector<Vector3d> exact;
  for (const Vector3i& p : points) exact.emplace_back(p.cast<double>() / 1024.0);
  return exact;
}

std::vector<Vector3d> kept_of(const std::vector<Vector3d>& points,
                              const std::vector<std::uint8_t>& kept) {
  std::vector<Vector3d> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i] != 0) result.push_back(points[i]);
  }
  return result;
}

using Cube = std::tuple<double, double, double>;
Cube cube_of(const Vector3d& p, double edge) {
  const Vector3d c = (p / edge).array().floor();
  return {c.x(), c.y(), c.z()};
}

TEST(GridThinning, KeepsFirstOfEachCube) {
  const std::vector<Vector3d> points = exact(ball(5000));
  GridThinning thinning;
  const std::vector<std::uint8_t> kept = thinning.select(points, 1000);
  std::set<Cube> cubes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(cubes.insert(cube_of(points[i], thinning.edge())).second, kept[i] != 0) << i;
  }
  EXPECT_LE(cubes.size(), 1000U);
  std::set<Cube> finer;
  for (const Vector3d& p : points) finer.insert(cube_of(p, 0.5 * thinning.edge()));
  EXPECT_GT(finer.size(), 1000U) << "the grid could be finer";
}

TEST(GridThinning, AcceptsAnyFiniteCoordinates) {
  constexpr double kHuge = std::numeric_limits<double>::max();
  const std::vector<Vector3d> huge = {{kHuge, -kHuge, kHuge}, {-kHuge, kHuge, -kHuge}};
  for (const int others : {0, 1, 3000}) {
    std::vector<Vector3d> points = exact(ball(others));
    for (int copies = 0; copies < 10; ++copies) {
      points.insert(points.end(), huge.begin(), huge.end());
    }
    GridThinning thinning;
    const std::vector<Vector3d> kept = kept_of(points, thinning.select(points, 1000));
    EXPECT_GT(kept.size(), static_cast<std::size_t>(others / 8));
    EXPECT_LE(kept.size(), 1000U);
    EXPECT_TRUE(std::isfinite(thinning.edge()) && thinning.edge() > 0.0);
    if (others == 3000) {
      EXPECT_LT(thinning.edge(), 1.0) << "a few points far away do not enlarge the cubes";
    }
  }
}

TEST(GridThinning, LeavesWhatFits) {
  const std::vector<Vector3d> points = exact(ball(500));
  const std::set<Cube> distinct = [&] {
    std::set<Cube> all;
    for (const Vector3d& p : points) all.insert(cube_of(p, 1.0 / 1024.0));
    return all;
  }();
  EXPECT_EQ(kept_of(points, GridThinning().select(points, 500)).size(), distinct.size());
}

// A list that is thinned as it grows keeps what it keeps when it is thinned at once.
TEST(GridThinning, GrowingListIsAsDenseEverywhere) {
  const std::vector<Vector3d> points = exact(ball(20'000));
  GridThinning growing;
  std::vector<Vector3d> list;
  double edge = 0.0;
  for (const Vector3d& p : points) {
    list.push_back(p);
    if (list.size() == 1000) {
      list = kept_of(list, growing.select(list, 700));
      EXPECT_GE(growing.edge(), edge);
      edge = growing.edge();
    }
  }
  list = kept_of(list, growing.select(list, list.size()));
  GridThinning at_once;
  std::vector<Vector3d> wanted;
  for (std::size_t most = points.size(); wanted.empty() || at_once.edge() < edge; most /= 2) {
    wanted = kept_of(points, at_once.select(points, most));
  }
  ASSERT_EQ(at_once.edge(), edge);
  EXPECT_EQ(list, wanted);
}

TEST(GridThinning, FarPointsDoNotCoarsenTheRest) {
  std::vector<Vector3d> points = exact(ball(5000));
  GridThinning alone;
  (void)alone.select(points, 2000);
  for (const double far : {1e300, -1e300, 1e12}) points.emplace_back(far, 0.0, -far);
  GridThinning thinning;
  EXPECT_GE(kept_of(points, thinning.select(points, 2000)).size(), 500U);
  EXPECT_EQ(thinning.edge(), alone.edge());
}

TEST(GridThinning, KeepsOneOfEqualPoints) {
  for (const double x : {0.0, 1e-300, 4.5e5, -1e12}) {
    const std::vector<Vector3d> points(300, Vector3d(x, -x, 3.0));
    EXPECT_EQ(kept_of(points, GridThinning().select(points, 10)).size(), 1U) << x;
  }
  EXPECT_TRUE(GridThinning().select({}, 1).empty());
}

class Thinning : public TestFiles {
 protected:
  static ReadOptions at_most(std::uint64_t points) {
    ReadOptions options;
    options.most_points = points;
    return options;
  }

  static std::string rows(const std::vector<Vector3i>& points) {
    std::string text;
    for (const Vector3d& p : exact(points)) {
      char row[100];
      std::snprintf(row, sizeof row, "%.10f %.10f %.10f\n", p.x(), p.y(), p.z());
      text += row;
    }
    return text;
  }
  static std::string floats(const std::vector<Vector3i>& points) {
    std::string bytes;
    for (const Vector3d& p : exact(points)) {
      const Eigen::Vector3f f = p.cast<float>();
      bytes += bytes_of(Corner{f.x(), f.y(), f.z()});
    }
    return bytes;
  }
  static std::string ply(const std::string& encoding, std::size_t count) {
    return "ply\nformat " + encoding + " 1.0\nelement vertex " + std::to_string(count) +
           "\nproperty float x\nproperty float y\nproperty float z\n";
  }
  static std::string pcd(const std::string& data, std::size_t count) {
    const std::string number = std::to_string(count);
    return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + number +
           "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA " + data + "\n";
  }
};

std::string las_of(const std::vector<Vector3i>& points) {
  LasFile file;
  file.scale = {1.0 / 1024, 1.0 / 1024, 1.0 / 1024};
  for (const Vector3i& p : points) file.points.push_back({{p.x(), p.y(), p.z()}});
  return las_file(file);
}

E57TestScan e57_of(const std::vector<Vector3i>& points, const std::string& pose = "") {
  std::vector<double> xyz[3];
  for (const Vector3d& p : exact(points)) {
    for (int axis = 0; axis < 3; ++axis) xyz[axis].push_back(p[axis]);
  }
  return {{e57_double("cartesianX", xyz[0]), e57_double("cartesianY", xyz[1]),
           e57_double("cartesianZ", xyz[2])},
          pose,
          16'000,
          ""};
}

TEST_F(Thinning, SamePointsOfEveryFormat) {
  const std::vector<Vector3i> points = ball(6000);
  const std::string count = std::to_string(points.size());
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.xyz", rows(points)},
      {"a.pts", count + "\n" + rows(points)},
      {"a.ply", ply("ascii", points.size()) + "end_header\n" + rows(points)},
      {"b.ply", ply("binary_little_endian", points.size()) + "end_header\n" + floats(points)},
      {"a.pcd", pcd("ascii", points.size()) + rows(points)},
      {"b.pcd", pcd("binary", points.size()) + floats(points)},
      {"a.las", las_of(points)},
      {"a.e57", e57_file({e57_of(points)})}};
  const Scan all = read_scan(write("all.xyz", rows(points)));
  ASSERT_EQ(all.positions, exact(points));
  std::vector<Vector3d> kept;
  for (const auto& [name, bytes] : files) {
    const Scan scan = read_scan(write(name, bytes), at_most(1500));
    EXPECT_LE(scan.positions.size(), 1500U) << name;
    EXPECT_GE(scan.positions.size(), 300U) << name;
    EXPECT_EQ(dropped(scan, kBeyondMemoryLimit), points.size() - scan.positions.size()) << name;
    ASSERT_FALSE(scan.notes.empty()) << name;
    expect_parts(scan.notes.back(), name, "of 6000 points", "--memory-limit",
                 std::to_string(scan.positions.size()));
    kept = kept.empty() ? scan.positions : kept;
    EXPECT_EQ(scan.positions, kept) << name;
    EXPECT_EQ(read_scan(write(name, bytes), at_most(6000)).positions, all.positions) << name;
  }
}

TEST_F(Thinning, LastPointsAreAsFarApart) {
  for (const int count : {2000, 2500, 3000}) {  // the list is full at different places
    const std::string once = rows(ball(count));
    const Scan scan = read_scan(write("a.xyz", once + once), at_most(1500));
    std::set<Cube> distinct;
    for (const Vector3d& p : scan.positions) distinct.insert({p.x(), p.y(), p.z()});
    EXPECT_EQ(distinct.size(), scan.positions.size()) << count;
  }
}

TEST_F(Thinning, RefusesLargeMeshAsBefore) {
  const std::vector<Vector3i> points = ball(6000);
  const std::string file = ply("binary_little_endian", points.size()) +
                           "element face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                           floats(points) + '\3' + bytes_of(std::array{0, 1, 2});
  EXPECT_EQ(read_scan(write("m.ply", file), at_most(1500)).positions.size(), 6000U);
  ReadOptions small = at_most(1500);
  small.scan_memory_bytes = 100'000;
  expect_parts(refusal(write("m.ply", file), small), "too large", "6000 points");
}

TEST_F(Thinning, LimitOfPointsReplacesThatOfMemory) {
  const std::filesystem::path file = write("a.xyz", rows(ball(6000)));
  ReadOptions options;
  options.scan_memory_bytes = 1000;
  expect_parts(refusal(file, options), "too large");
  for (const std::uint64_t most : {1U, 4U, 1500U, 100'000U}) {
    options.most_points = most;
    const Scan scan = read_scan(file, options);
    EXPECT_LE(scan.positions.capacity(), std::max<std::uint64_t>(most, 4));
    EXPECT_EQ(scan.positions.size() == 6000, most > 6000);
  }
}

TEST_F(Thinning, PosesKeepTheirPoints) {
  // The second scanner saw the same place as the first, so that nothing of it is left.
  const std::vector<Vector3i> near = ball(3000);
  std::vector<Vector3i> far = ball(3000);
  for (Vector3i& p : far) p.x() += 10'000;
  const std::string file = e57_file({e57_of(near, e57_pose("1 0 0 0", "0 0 0")),
                                     e57_of(near, e57_pose("1 0 0 0", "0 0 0")),
                                     e57_of(far, e57_pose("1 0 0 0", "0 0 0.5"))});
  const Scan scan = read_scan(write("a.e57", file), at_most(2000));
  EXPECT_LE(scan.positions.size(), 2000U);
  const Scan whole = read_scan(write("a.e57", file), at_most(9000));
  ASSERT_EQ(whole.poses.size(), 3U);
  ASSERT_EQ(scan.poses.size(), 2U);
  EXPECT_EQ(scan.poses[0].first_point, 0U);
  EXPECT_EQ(scan.poses[1].position.z(), 0.5);
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    EXPECT_EQ(scan.positions[i].x() > 5.0, i >= scan.poses[1].first_point) << i;
  }
}

TEST(ScanBuilder, ThinsNormalsAndColoursWithPoints) {
  ReadOptions options;
  options.most_points = 500;
  ScanBuilder builder("scan", options, "line");
  builder.use_normals();
  builder.use_colours(ColourRange::kByte);
  builder.thin_large_cloud();
  builder.reserve_points(5000);
  PointRow bad{};
  bad[kY] = std::numeric_limits<double>::quiet_NaN();
  builder.add_point(bad);
  for (const Vector3d& p : exact(ball(4999))) {
    const double x = std::abs(p.x());
    builder.add_point({p.x(), p.y(), p.z(), p.x(), p.y(), p.z(), 100.0 * x, 0.0, 255.0});
  }
  const Scan scan = builder.finish("test");
  EXPECT_LE(scan.positions.size(), 500U);
  ASSERT_EQ(scan.normals.size(), scan.positions.size());
  ASSERT_EQ(scan.colours.size(), scan.positions.size());
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    EXPECT_EQ(scan.normals[i], scan.positions[i].cast<float>());
    EXPECT_NEAR(scan.colours[i][0], 100.0 * std::abs(scan.positions[i].x()), 0.5);
  }
  EXPECT_EQ(dropped(scan, "non_finite"), 1U);
  EXPECT_EQ(dropped(scan, kBeyondMemoryLimit) + scan.positions.size(), 4999U);
}

TEST(ScanBuilder, ThinningKeepsTheRangesOfColoursApart) {
  ReadOptions options;
  options.most_points = 500;
  ScanBuilder builder("scan", options, "line");
  builder.use_colours(ColourRange::kAuto);
  builder.thin_large_cloud();
  builder.reserve_points(4000);
  const std::vector<Vector3d> points = exact(ball(4000));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 300) builder.begin_colours(ColourRange::kAuto);
    const double full = i < 300 ? 1.0 : i < 3999 ? 255.0 : 65535.0;
    builder.add_point({points[i].x(), points[i].y(), points[i].z(), 0, 0, 0, full, 0, 0});
  }
  const Scan scan = builder.finish("test");
  ASSERT_EQ(scan.colours.size(), scan.positions.size());
  for (std::size_t i = 0; i < scan.positions.size(); ++i) {
    const auto at = std::find(points.begin(), points.end(), scan.positions[i]) - points.begin();
    const int red = at < 300 || at == 3999 ? 255 : 1;
    EXPECT_EQ(scan.colours[i][0], red) << at;
  }
}

}  // namespace
}  // namespace tactree::builder
