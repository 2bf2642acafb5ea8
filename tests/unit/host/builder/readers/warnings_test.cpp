// The warnings of the readers: each for the file that has its fault, and none for the same file
// without it.

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "e57_writer.hpp"
#include "las_writer.hpp"
#include "mesh_writers.hpp"
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using namespace std::string_literals;

const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kFaces = "3 0 1 2\n3 0 2 3\n";

struct Fault {
  std::vector<std::string> warnings;  ///< a part of each
  std::string faulty;
  std::string sound;
};

std::string ply(const std::string& points, const std::string& faces, int face_count,
                const std::string& before = "", const std::string& normals = "") {
  return "ply\nformat ascii 1.0\n" + before + "element vertex " +
         std::to_string(std::count(points.begin(), points.end(), '\n')) +
         "\nproperty float x\nproperty float y\nproperty float z\n" + normals + "element face " +
         std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" +
         points + faces;
}

std::vector<Fault> ply_and_off_faults() {
  const std::string sound = ply(kSquare, kFaces, 2);
  const std::string normal = "property float nx\nproperty float ny\nproperty float nz\n";
  const std::string directions = "0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n";
  const std::string off = "OFF\n4 2 0\n" + kSquare + kFaces;
  return {
      {{"1 line of the header is unknown"}, ply(kSquare, kFaces, 2, "hello world\n"), sound},
      {{"1 of 5 points were dropped"}, ply("nan 0 0\n" + kSquare, "3 1 2 3\n", 1), sound},
      {{"1 of 5 points were dropped", "1 of 2 faces were dropped with their points"},
       ply("0 inf 0\n" + kSquare, "3 0 1 2\n3 1 2 3\n", 2),
       sound},
      {{"1 of 3 faces were dropped: they refer to"}, ply(kSquare, kFaces + "3 0 1 9\n", 3), sound},
      {{"declares 1 rows of \"face\" and holds 2"}, ply(kSquare, kFaces, 1), sound},
      {{"1 points have a normal that is not a number"},
       ply(directions + "0 1 0 nan 0 0\n", kFaces, 2, "", normal),
       ply(directions + "0 1 0 0 0 1\n", kFaces, 2, "", normal)},
      {{"declares 1 faces and holds 2"}, "OFF\n4 1 0\n" + kSquare + kFaces, off},
      {{"declares 3 points and holds 4"}, "OFF\n3 0 0\n" + kSquare, "OFF\n4 0 0\n" + kSquare},
  };
}

std::vector<Fault> obj_faults() {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::string coloured = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\n";
  return {
      {{"The normals were ignored"},
       points + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n",
       points + "vn 0 0 1\nvn 0 0 2\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n"},
      {{"taken to count from 0"}, points + "f 0 1 2\nf 0 2 3\n", points + "f 1 2 3\nf 1 3 4\n"},
      {{"1 points have no colour"},
       coloured + "v 0 1 0\nf 1 2 3\n",
       coloured + "v 0 1 0 1 0 0\nf 1 2 3\n"},
  };
}

std::string stl_binary(std::optional<std::uint32_t> count, const std::string& after = "") {
  std::string bytes(80, '\0');
  if (count) bytes += bytes_of(*count);
  for (int i = 0; i < 20; ++i) {
    const auto x = static_cast<float>(i);
    bytes += facet({Corner{x, 0, 0}, Corner{x + 1, 0, 0}, Corner{x, 1, 0}});
  }
  return bytes + after;
}

std::vector<Fault> stl_faults() {
  const std::string text =
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\n";
  return {
      {{"ends without endsolid"}, text, text + "endsolid a\n"},
      {{"3 bytes after the last of 20 triangles"}, stl_binary(20, "end"), stl_binary(20)},
      {{"declares 19 triangles and holds 20"}, stl_binary(19), stl_binary(20)},
      {{"declares 0 triangles; by its size it holds 20"}, stl_binary(0), stl_binary(20)},
      {{"no count after its first 80 bytes"}, stl_binary({}), stl_binary(20)},
  };
}

std::string pcd(const std::string& body, int width, int height, int points,
                const std::string& data = "ascii") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
         std::to_string(width) + "\nHEIGHT " + std::to_string(height) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n" +
         body;
}

/// Points (0 0 0), (1 0 0), (1 1 0) as literal runs.
std::string pcd_compressed(const std::string& after) {
  std::string floats;
  for (const float value : {0.0F, 1.0F, 1.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F}) {
    floats += bytes_of(value);
  }
  std::string runs;
  for (std::size_t at = 0; at < floats.size(); at += 32) {
    const std::string run = floats.substr(at, 32);
    runs += static_cast<char>(run.size() - 1) + run;
  }
  return pcd(bytes_of(static_cast<std::uint32_t>(runs.size())) +
                 bytes_of(static_cast<std::uint32_t>(floats.size())) + runs + after,
             3, 1, 3, "binary_compressed");
}

std::string lines(const std::vector<std::string>& rows) {
  std::string text;
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

std::vector<std::string> shuffled(std::vector<std::string> rows) {
  std::shuffle(rows.begin(), rows.end(), std::minstd_rand(7));
  return rows;
}

std::vector<Fault> scanner_faults() {
  std::vector<std::string> image;
  std::vector<std::string> sweep;
  for (int i = 0; i < 120; ++i) {
    const double x = 0.1 * (i % 12) - 0.5;
    image.push_back(std::to_string(x) + " " + std::to_string(0.1 * (i / 12) - 0.5) + " " +
                    std::to_string(1 + 0.1 * x));
    const double azimuth = 0.1 * (i / 10);
    const double elevation = 0.1 * (i % 10) - 0.5;
    const double range = 2 + 0.1 * (i / 10);
    sweep.push_back(std::to_string(range * std::cos(elevation) * std::cos(azimuth)) + " " +
                    std::to_string(range * std::cos(elevation) * std::sin(azimuth)) + " " +
                    std::to_string(range * std::sin(elevation)) + " 0.5");
  }
  const std::string ptx =
      "12\n10\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  return {
      {{"WIDTH times HEIGHT is 3"}, pcd(kSquare, 3, 1, 4), pcd(kSquare, 4, 1, 4)},
      {{"declares 3 points and holds 4"}, pcd(kSquare, 3, 1, 3), pcd(kSquare, 4, 1, 4)},
      {{"5 bytes after the 3 points"}, pcd_compressed("extra"), pcd_compressed("")},
      {{"do not fit the VIEWPOINT"},
       pcd(lines(shuffled(image)), 12, 10, 120),
       pcd(lines(image), 12, 10, 120)},
      {{"In 1 of 1 scans the order of the points"},
       ptx + lines(shuffled(sweep)),
       ptx + lines(sweep)},
  };
}

std::vector<Fault> table_faults() {
  std::vector<std::string> rows;
  for (int i = 0; i < 400; ++i) {
    const double x = 0.011 * (i % 17);
    const double y = 0.013 * (i * 7 % 19) - 0.1;
    rows.push_back(std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(0.3 + x * y));
  }
  const auto with = [&](const std::string& after) {
    std::vector<std::string> longer = rows;
    for (std::string& row : longer) row += after;
    return lines(longer);
  };
  return {
      {{"declares 399 points and holds 400"}, "399\n" + lines(rows), "400\n" + lines(rows)},
      {{"1 line before the first row was skipped"},
       "a title\n" + lines(rows),
       "# a title\n" + lines(rows)},
      {{"1 row was dropped: line 401 is not a point"}, lines(rows) + "1 2\n", lines(rows)},
      {{"2 rows were dropped"}, lines(rows) + "1 2\n3 4\n", lines(rows)},
      {{"Columns 4 to 6 were ignored: they are neither"}, with(" 0.5 700 1"), with(" 0.6 0 0.8")},
      {{"as colours they would be nearly black"}, with(" 2 1 1"), with(" 20 100 100")},
  };
}

std::vector<Fault> laser_faults() {
  using namespace test;
  E57TestScan plain = {{e57_double("cartesianX", {0, 1, 2}), e57_double("cartesianY", {0, 1, 1}),
                        e57_double("cartesianZ", {1, 1, 3})},
                       "",
                       7,
                       ""};
  E57TestScan coloured = plain;
  for (const char* const name : {"colorRed", "colorGreen", "colorBlue"}) {
    coloured.columns.push_back(e57_integer(name, 0, 255, {1, 2, 3}));
  }
  LasFile las;
  las.points = {{{1, 2, 3}, {}}, {{5, 6, 7}, {}}};
  LasFile degrees = las;
  degrees.records = las_geo_keys({{1024, 2}});
  degrees.record_count = 1;
  return {
      {{"Only 1 of 2 scans have colours"},
       e57_file({plain, coloured}),
       e57_file({coloured, coloured})},
      {{"longitude and latitude in degrees"}, las_file(degrees), las_file(las)},
  };
}

class WarningsTest : public TestFiles {
 protected:
  static std::string joined(const std::vector<std::string>& warnings) {
    std::string text;
    for (const std::string& warning : warnings) text += "\n  " + warning;
    return text;
  }
};

TEST_F(WarningsTest, AppearForTheirFaultOnly) {
  std::size_t faults = 0;
  for (auto* const list : {&ply_and_off_faults, &obj_faults, &stl_faults, &scanner_faults,
                           &table_faults, &laser_faults}) {
    for (const Fault& fault : list()) {
      const std::string& name = fault.warnings.front();
      const Scan faulty = read(fault.faulty);
      ASSERT_EQ(faulty.warnings.size(), fault.warnings.size()) << name << joined(faulty.warnings);
      for (std::size_t i = 0; i < fault.warnings.size(); ++i) {
        expect_parts(faulty.warnings[i], fault.warnings[i]);
      }
      const Scan sound = read(fault.sound);
      EXPECT_TRUE(sound.warnings.empty()) << "without " << name << joined(sound.warnings);
      ++faults;
    }
  }
  EXPECT_GE(faults, 29U);
}

}  // namespace
}  // namespace tactree::builder
