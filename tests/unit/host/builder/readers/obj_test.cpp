#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;
using Triangle = std::array<std::uint32_t, 3>;

class ObjTest : public TestFiles {};

constexpr const char* kFour = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjTest, ReadsFacesOfAllForms) {
  const Scan scan = read(std::string("# c\no thing\n") + kFour +
                         "vt 0 0\nvn 0 0 1\nusemtl m\ns off\nf 1 2 3\nf 1/1 3/1 4/1\n"
                         "f 1//1 2//1 3//1\nf -4/1/1 -2/1/1 -1/1/1\nf 1 2 \\\n 3 4\n");
  EXPECT_EQ(scan.format, "OBJ");
  EXPECT_EQ(scan.positions.size(), 4U);
  ASSERT_EQ(scan.triangles.size(), 6U);
  EXPECT_EQ(scan.triangles[1], (Triangle{0, 2, 3}));
  EXPECT_EQ(scan.triangles[3], (Triangle{0, 2, 3}));
  EXPECT_EQ(scan.triangles[5], (Triangle{0, 2, 3}));
  EXPECT_TRUE(scan.dropped.empty());
}

TEST_F(ObjTest, JoinsOnlyLinesOfNumbers) {
  for (const std::string name : {"# of C:\\scans\\", "mtllib C:\\scans\\", "usemtl a\\", "g a\\",
                                 "o a\\", "s 1 # \\", "vt 0 0 # \\"}) {
    const Scan scan = read(name + '\n' + kFour + "f 1 2 3\n");
    EXPECT_EQ(scan.positions.size(), 4U) << name;
    EXPECT_EQ(scan.triangles.size(), 1U) << name;
  }
  const Scan joined =
      read("v 0 0 \\\n 0\nv 1 \\ \n 0 \\\n 0\nv 0 1 0\nf 1 \\\n2 3 # \\\nv 5 5 5\n");
  EXPECT_EQ(joined.positions.size(), 4U);
  EXPECT_EQ(joined.triangles.size(), 1U);
}

TEST_F(ObjTest, RefusesFreeFormSurfacesWithoutFaces) {
  const std::string surface = "cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nend\n";
  expect_parts(refusal_of(kFour + surface, "a.obj"), "a.obj", "line 7", "NURBS", "tessellate");
  const Scan scan = read(kFour + surface + "f 1 2 3\n");
  EXPECT_EQ(scan.triangles.size(), 1U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "1 curves or surfaces", "line 7", "tessellate");
}

TEST_F(ObjTest, LargeCoordinatesKeepTheirMicrometres) {
  EXPECT_EQ(read("v 636123.123456 851218.654321 0.000001\n").positions.at(0),
            Eigen::Vector3d(636123.123456, 851218.654321, 0.000001));
}

TEST_F(ObjTest, KeepsAgreeingNormals) {
  const Scan scan =
      read(std::string(kFour) + "vn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//1\nf 1//2 3//2 4//1\n");
  ASSERT_EQ(scan.normals.size(), 4U);
  EXPECT_EQ(scan.normals[2], Eigen::Vector3f(0, 0, 1));
}

TEST_F(ObjTest, IgnoresDifferingNormalsWithWarning) {
  const Scan scan =
      read(std::string(kFour) + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
  EXPECT_TRUE(scan.normals.empty());
  EXPECT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.warnings.size(), 1U);
}

TEST_F(ObjTest, ReadsCloudsAndWireframes) {
  const Scan cloud = read("vn 0 0 1\nv 1 2 3\nvn 0 1 0\nv nan 5 6\nvn 1 0 0\nv 7 8 9\n");
  EXPECT_FALSE(cloud.is_mesh());
  ASSERT_EQ(cloud.normals.size(), 2U);
  EXPECT_EQ(cloud.normals[1], Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(dropped(cloud, "non_finite"), 1U);
  const Scan wires = read(std::string(kFour) + "l 1 2\nl 2 3 4\n");
  EXPECT_EQ(wires.positions.size(), 4U);
  EXPECT_FALSE(wires.is_mesh());
}

TEST_F(ObjTest, ReadsColours) {
  const Scan unit = read("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\n");
  EXPECT_EQ(unit.colours.at(0), (Colour{255, 128, 0}));
  const Scan bytes = read("v 0 0 0 255 128 0\nv 1 0 0 0 0 1\n");
  EXPECT_EQ(bytes.colours.at(1), (Colour{0, 0, 1}));
  const Scan partly = read("v 0 0 0\nv 1 0 0 0 0 1\n");
  EXPECT_EQ(partly.colours.at(0), (Colour{255, 255, 255}));
  const Scan partly_bytes = read("v 0 0 0\nv 0 1 0 0 0 1\nv 1 0 0 0 200 1\n");
  EXPECT_EQ(partly_bytes.colours.at(0), (Colour{255, 255, 255}));
  EXPECT_EQ(partly.warnings.size(), 1U);
  EXPECT_TRUE(read("v 0 0 0 1\nv 1 0 0 1\n").colours.empty());  // w
}

TEST_F(ObjTest, ConcaveFaceStaysInsideOutline) {
  const Scan scan = read("v 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nf 1 2 3 4 5 6\n");
  double area = 0;
  for (const Triangle& t : scan.triangles) {
    const Eigen::Vector3d a = scan.positions[t[1]] - scan.positions[t[0]];
    const Eigen::Vector3d b = scan.positions[t[2]] - scan.positions[t[0]];
    area += std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
  }
  EXPECT_NEAR(area, 3.0, 1e-12);
}

TEST_F(ObjTest, ReadsFacesBeforePoints) {
  const Scan scan = read(std::string("v 9 9 9\nf 2 3 4\nf 1 2 99\n") + kFour);
  ASSERT_EQ(scan.triangles.size(), 1U);
  EXPECT_EQ(scan.triangles[0], (Triangle{1, 2, 3}));
  EXPECT_EQ(dropped(scan, "face_index_out_of_range"), 1U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "line 3");
}

/// The recogniser sees only their beginning.
TEST_F(ObjTest, ReadsManyNormalsBeforePoints) {
  std::string text;
  for (int i = 0; i < 30000; ++i) text += "vn 0 0 1\n";
  EXPECT_EQ(read(text + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").triangles.size(), 1U);
}

TEST_F(ObjTest, CountsBrokenFaces) {
  const Scan scan = read(std::string(kFour) +
                         "f 1 2 3\nf 1 2 5\nf 0 1 2\nf -5 1 2\nf 1 2\nf\nf a b c\nf 1 1 2\n");
  EXPECT_EQ(scan.triangles.size(), 1U);
  EXPECT_EQ(dropped(scan, "face_index_out_of_range"), 4U);
  EXPECT_EQ(dropped(scan, "degenerate_face"), 3U);
  expect_parts(refusal_of(std::string(kFour) + "f 1 2 999999999\nf 1 2 77777777777777777777\n"),
               "line 5", "none of the 2 faces");
}

TEST_F(ObjTest, RefusesTooManyFaces) {
  std::string text = kFour;
  for (int i = 0; i < 5000; ++i) text += i % 2 == 0 ? "f 1 2 3 4\n" : "f 1 2 3\n";
  const auto path = write("faces.obj", text);
  ReadOptions options;
  options.scan_memory_bytes = 200'000;
  EXPECT_EQ(read_scan(path, options).triangles.size(), 7500U);
  options.scan_memory_bytes = 80'000;
  expect_parts(refusal(path, options), "too large", "4 points");
}

TEST_F(ObjTest, RefusesBrokenPoint) {
  expect_parts(refusal_of("v 0 0 0\nv 1 0\nv 1 1 0\nf 1 2 3\n", "m.obj"), "m.obj", "line 2",
               "fewer than three numbers");
}

}  // namespace
}  // namespace tactree::builder
