// Files whose header states another number than the file holds, and other dialects of the counts.

#include "test_files.hpp"

namespace tactree::builder {
namespace {

class CountsTest : public TestFiles {
 protected:
  /// The only warning of a file, which must be read.
  std::string warning_of(const std::string& bytes) {
    last_ = read(bytes);
    EXPECT_EQ(last_.warnings.size(), 1U) << bytes.substr(0, 60);
    return last_.warnings.empty() ? "" : last_.warnings.front();
  }
  void expect_no_warning(const std::string& bytes) {
    last_ = read(bytes);
    EXPECT_TRUE(last_.warnings.empty()) << last_.warnings.front();
  }

  Scan last_;
};

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

std::string ply_header(const std::string& format, int points, int faces,
                       const std::string& more = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(points) +
         "\nproperty float x\nproperty float y\nproperty float z\n" +
         (faces < 0 ? ""
                    : "element face " + std::to_string(faces) +
                          "\nproperty list uchar int vertex_indices\n") +
         more + "end_header\n";
}

std::string binary_points(int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += bytes_of(Corner{static_cast<float>(i), 0.5F, 0.25F});
  return bytes;
}

std::string binary_face() { return "\3" + bytes_of(std::array<int, 3>{0, 1, 2}); }

TEST_F(CountsTest, ReportsExtraPlyRows) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  expect_no_warning(ply_header("ascii", 3, 1) + points + "3 0 1 2\n\n");
  expect_parts(warning_of(ply_header("ascii", 3, 1) + points + "3 0 1 2\n3 0 2 1\n\n3 1 2 0\n"),
               "declares 1 rows of \"face\"", "holds 3", "last 2 were left out");
  EXPECT_EQ(last_.triangles.size(), 1U);
  expect_parts(warning_of(ply_header("ascii", 3, -1) + points + "5 5 5\n"), "declares 3 vertices",
               "holds 4");
  const std::string edges = "element edge 2\nproperty int vertex1\nproperty int vertex2\n";
  expect_no_warning(ply_header("ascii", 3, 1, edges) + points + "3 0 1 2\n0 1\n1 2\n");
  expect_parts(warning_of(ply_header("ascii", 3, 1, edges) + points + "3 0 1 2\n0 1\n1 2\n2 0\n"),
               "holds 2");
}

TEST_F(CountsTest, ReportsExtraBinaryPlyRows) {
  const std::string binary = "binary_little_endian";
  expect_no_warning(ply_header(binary, 30, -1) + binary_points(30));
  expect_parts(warning_of(ply_header(binary, 30, -1) + binary_points(60)), "declares 30 vertices",
               "holds 60", "last 30 were left out");
  EXPECT_EQ(last_.positions.size(), 30U);
  expect_parts(
      warning_of(ply_header(binary, 30, 10) + binary_points(30) + repeated(binary_face(), 20)),
      "declares 10 rows of \"face\"", "holds 20");
  expect_parts(
      warning_of(ply_header(binary, 30, 0) + binary_points(30) + repeated(binary_face(), 20)),
      "declares 0 rows of \"face\"", "holds 20");
  expect_no_warning(ply_header(binary, 30, -1) + binary_points(30) + "\n");
  expect_no_warning(ply_header(binary, 30, -1) + binary_points(30) + std::string(4096, '\0'));
}

TEST_F(CountsTest, ReportsNonNumericPlyIndex) {
  const Scan scan = read(ply_header("ascii", 3, 4) +
                         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 nan 2\n3 0 1 1e30\n3 0.0 2.0 1.0\n");
  EXPECT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(dropped(scan, "face_index_out_of_range"), 2U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "2 of 4 faces", "line 14");
  expect_parts(refusal_of(ply_header("ascii", 3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 here 2\n"),
               "\"here\"");
}

TEST_F(CountsTest, ReportsExtraOffRows) {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  expect_no_warning("OFF\n3 1 0\n" + points + "3 0 1 2\n\n# the end\n");
  expect_parts(warning_of("OFF\n3 1 0\n" + points + "3 0 1 2\n3 0 2 1\n"), "declares 1 faces",
               "holds 2", "last 1 were left out");
  expect_parts(warning_of("OFF\n3 0 0\n" + points + "7 7 7\n"), "declares 3 points", "holds 4");
  const Scan nan = read("OFF\n3 2 0\n" + points + "3 0 1 2\n3 0 nan 2\n");
  EXPECT_EQ(nan.triangles.size(), 1U);
  EXPECT_EQ(dropped(nan, "face_index_out_of_range"), 1U);
}

std::string pcd(const std::string& data, int points) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
         std::to_string(points) + "\nHEIGHT 1\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

TEST_F(CountsTest, ReportsExtraPcdPoints) {
  expect_no_warning(pcd("ascii", 2) + "1 2 3\n4 5 6\n\n");
  expect_parts(warning_of(pcd("ascii", 2) + "1 2 3\n4 5 6\n\n7 8 9\n1 1 1\n"), "declares 2 points",
               "holds 4");
  expect_no_warning(pcd("binary", 30) + binary_points(30));
  expect_no_warning(pcd("binary", 30) + binary_points(30) + std::string(4096, '\0'));
  expect_parts(warning_of(pcd("binary", 30) + binary_points(60)), "declares 30 points", "holds 60");
  // 12 bytes as one literal run of LZF.
  const std::string packed = bytes_of(13U) + bytes_of(12U) + "\x0b" + binary_points(1);
  expect_no_warning(pcd("binary_compressed", 1) + packed);
  expect_parts(warning_of(pcd("binary_compressed", 1) + packed + packed), "21 bytes", "1 points");
}

std::string flat_facets(int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<float>(i) * 0.001F;
    bytes += facet({Corner{at, 0.001F, 0}, Corner{at + 0.001F, 0.001F, 0}, Corner{at, 0.002F, 0}});
  }
  return bytes;
}

std::string stl_head() { return "made for a test" + std::string(65, ' '); }

TEST_F(CountsTest, ReportsWrongStlCount) {
  expect_parts(warning_of(stl_head() + bytes_of(20U) + flat_facets(50)), "declares 20 triangles",
               "holds 50");
  EXPECT_EQ(last_.triangles.size(), 20U);
  expect_parts(warning_of(stl_head() + bytes_of(20U) + flat_facets(20) + "with a note"),
               "11 bytes after the last of 20 triangles");
  expect_no_warning(stl_head() + bytes_of(20U) + flat_facets(20) + std::string(500, '\0'));
  expect_parts(warning_of(stl_head() + bytes_of(0U) + flat_facets(50)), "declares 0 triangles",
               "holds 50, which were read");
  EXPECT_EQ(last_.triangles.size(), 50U);
  expect_parts(refusal_of(stl_head() + bytes_of(0U) + std::string(50, '\0')), "not a scan");
}

TEST_F(CountsTest, ReadsStlWithoutCount) {
  // A normal of (0, 0, 1) is also plausible four bytes further on.
  expect_parts(warning_of(stl_head() + flat_facets(50)), "has no count", "holds 50 triangles");
  ASSERT_EQ(last_.triangles.size(), 50U);
  EXPECT_EQ(last_.positions.at(0), Eigen::Vector3d(0, static_cast<double>(0.001F), 0));
}

TEST_F(CountsTest, ReadsTextStlDialects) {
  const std::string corners = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n";
  const std::string cases[] = {
      "solid part\nfacet normal 0 0 1\nouter loop\n" + corners +
          "endloop\nendfacet\nend solid part\n",
      "solid part\nfacet normal 0 0 1 outer loop\nvertex 0 0 0 vertex 1 0 0 vertex 0 1 0\n"
      "endloop endfacet\nendsolid part\n",
      "solid a facet of it facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
      "endloop endfacet endsolid a facet of it",
      "SOLID part\n FACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\n"
      "END LOOP\nEND FACET\nEND SOLID\n",
      "solid\nfacet\nouter loop\n" + corners + "endloop\nendfacet\nendsolid\n",
      "solid\ncolor 0.5 0.5 0.5\nfacet normal nan nan nan\nouter loop\n" + corners +
          "endloop\nendfacet\nendsolid vertex\n",
  };
  for (const std::string& text : cases) {
    expect_no_warning(text);
    EXPECT_EQ(last_.format, "STL ascii") << text;
    EXPECT_EQ(last_.triangles.size(), 1U) << text;
    EXPECT_EQ(last_.positions.size(), 3U) << text;
  }
}

constexpr const char* kBox =
    "v 0 0 0\nv 4 0 0\nv 0 2 0\nv 4 2 0\nv 0 0 3\nv 4 0 3\nv 0 2 3\nv 4 2 3\n";
constexpr std::array<std::array<int, 3>, 12> kBoxFaces = {{{0, 2, 3},
                                                           {0, 3, 1},
                                                           {4, 5, 7},
                                                           {4, 7, 6},
                                                           {0, 1, 5},
                                                           {0, 5, 4},
                                                           {2, 6, 7},
                                                           {2, 7, 3},
                                                           {0, 4, 6},
                                                           {0, 6, 2},
                                                           {1, 3, 7},
                                                           {1, 7, 5}}};

std::string box(int first) {
  std::string text = kBox;
  for (const auto& face : kBoxFaces) {
    text += "f";
    for (const int corner : face) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

TEST_F(CountsTest, ReadsZeroBasedObj) {
  expect_parts(warning_of(box(0)), "0 to 7 for 8 points", "count from 0");
  const Scan from_zero = last_;
  expect_no_warning(box(1));
  EXPECT_EQ(from_zero.triangles, last_.triangles);
  EXPECT_EQ(from_zero.positions, last_.positions);
  // One index of 0 beside the highest one of a file that counts from 1 is damage.
  expect_parts(warning_of(box(1) + "f 0 1 2\n"), "1 of 13 faces", "line 21");
  EXPECT_EQ(last_.triangles, from_zero.triangles);
  expect_parts(warning_of(std::string(kBox) + "f 0 1 2\nf -1 -2 -3\n"), "1 of 2 faces");
}

}  // namespace
}  // namespace tactree::builder
