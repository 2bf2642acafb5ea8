#include <array>
#include <vector>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;
using Triangle = std::array<std::uint32_t, 3>;

enum class Encoding { kAscii, kLittle, kBig };
constexpr Encoding kEncodings[] = {Encoding::kAscii, Encoding::kLittle, Encoding::kBig};

/// Writes one PLY in any encoding.
class Ply {
 public:
  explicit Ply(Encoding encoding, const std::string& line_end = "\n")
      : encoding_(encoding), line_end_(line_end) {
    line("ply");
    line(encoding == Encoding::kAscii    ? "format ascii 1.0"
         : encoding == Encoding::kLittle ? "format binary_little_endian 1.0"
                                         : "format binary_big_endian 1.0");
  }
  Ply& line(const std::string& text) {
    bytes_ += text + line_end_;
    return *this;
  }
  Ply& number(const std::string& type, double value) {
    if (encoding_ == Encoding::kAscii) {
      std::array<char, 40> text{};
      std::snprintf(text.data(), text.size(), "%.17g ", value);
      bytes_ += text.data();
      return *this;
    }
    bytes_ += binary(type, value, encoding_ == Encoding::kBig);
    return *this;
  }
  Ply& end_row() {
    if (encoding_ == Encoding::kAscii) bytes_ += line_end_;
    return *this;
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  static std::string binary(const std::string& type, double value, bool swap) {
    if (type == "char" || type == "int8") return bytes_of(static_cast<std::int8_t>(value));
    if (type == "uchar" || type == "uint8") return bytes_of(static_cast<std::uint8_t>(value));
    if (type == "short" || type == "int16") return bytes_of(static_cast<std::int16_t>(value), swap);
    if (type == "ushort" || type == "uint16") {
      return bytes_of(static_cast<std::uint16_t>(value), swap);
    }
    if (type == "int" || type == "int32") return bytes_of(static_cast<std::int32_t>(value), swap);
    if (type == "uint" || type == "uint32") {
      return bytes_of(static_cast<std::uint32_t>(value), swap);
    }
    if (type == "float" || type == "float32") return bytes_of(static_cast<float>(value), swap);
    return bytes_of(value, swap);
  }

  Encoding encoding_;
  std::string line_end_;
  std::string bytes_;
};

class PlyTest : public TestFiles {};

constexpr const char* kTypes[] = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                  "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                  "float",  "float32", "double", "float64"};

TEST_F(PlyTest, ReadsEveryTypeAndEncoding) {
  for (const Encoding encoding : kEncodings) {
    for (const std::string type : kTypes) {
      Ply ply(encoding);
      ply.line("element vertex 2");
      for (const char* name : {"x", "y", "z"}) ply.line("property " + type + " " + name);
      ply.line("end_header");
      ply.number(type, 1).number(type, 100).number(type, 127).end_row();
      ply.number(type, 4).number(type, 5).number(type, 6).end_row();
      const Scan scan = read(ply.bytes());
      ASSERT_EQ(scan.positions.size(), 2U) << type;
      EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1, 100, 127)) << type;
      EXPECT_EQ(scan.positions[1], Eigen::Vector3d(4, 5, 6)) << type;
    }
  }
}

TEST_F(PlyTest, ReadsNegativeNumbers) {
  for (const Encoding encoding : kEncodings) {
    for (const std::string type : {"char", "short", "int", "float", "double"}) {
      Ply ply(encoding);
      ply.line("element vertex 1");
      for (const char* name : {"x", "y", "z"}) ply.line("property " + type + " " + name);
      ply.line("end_header").number(type, -1).number(type, -100).number(type, -128).end_row();
      EXPECT_EQ(read(ply.bytes()).positions.at(0), Eigen::Vector3d(-1, -100, -128)) << type;
    }
  }
}

TEST_F(PlyTest, DoublesKeepTheirMicrometres) {
  for (const Encoding encoding : kEncodings) {
    Ply ply(encoding);
    ply.line("element vertex 1");
    for (const char* name : {"x", "y", "z"}) ply.line(std::string("property double ") + name);
    ply.line("end_header").number("double", 5648349.895035).number("double", 0.1);
    ply.number("double", 1e-7).end_row();
    EXPECT_EQ(read(ply.bytes()).positions.at(0), Eigen::Vector3d(5648349.895035, 0.1, 1e-7));
  }
}

/// Faces before the vertices, properties in odd order and of mixed types, unknown elements and
/// lists everywhere.
std::string tangled(Encoding encoding, const std::string& line_end) {
  Ply ply(encoding, line_end);
  ply.line("comment made for a test").line("obj_info nothing");
  ply.line("element camera 1").line("property list uchar float view").line("property int id");
  ply.line("element face 2").line("property uchar flags");
  ply.line("property list ushort double weights");
  ply.line("property list uchar uint vertex_indices").line("property short group");
  ply.line("comment between").line("element vertex 4").line("property uchar blue");
  ply.line("property double z").line("property list int short neighbours");
  ply.line("property float nx").line("property float x").line("property uchar red");
  ply.line("property float quality").line("property float nz").line("property double y");
  ply.line("property uchar green").line("property float ny");
  ply.line("element tail 1").line("property double unused").line("end_header");
  ply.number("uchar", 2).number("float", 1.5).number("float", 2.5).number("int", 7).end_row();
  ply.number("uchar", 1).number("ushort", 1).number("double", 0.5);
  ply.number("uchar", 3).number("uint", 0).number("uint", 1).number("uint", 2);
  ply.number("short", -3).end_row();
  ply.number("uchar", 1).number("ushort", 0);
  ply.number("uchar", 3).number("uint", 2).number("uint", 1).number("uint", 3);
  ply.number("short", -3).end_row();
  for (int i = 0; i < 4; ++i) {
    ply.number("uchar", 30 + i).number("double", i & 2 ? 5.0 : 0.0).number("int", i);
    for (int k = 0; k < i; ++k) ply.number("short", k);
    ply.number("float", 0).number("float", i & 1).number("uchar", 10 + i).number("float", 9);
    ply.number("float", 1).number("double", i == 3 ? 2.0 : 0.25).number("uchar", 20 + i);
    ply.number("float", 0).end_row();
  }
  ply.number("double", 3).end_row();
  return ply.bytes();
}

TEST_F(PlyTest, AcceptsUnknownPartsAndOrder) {
  for (const Encoding encoding : kEncodings) {
    for (const std::string line_end : {"\n", "\r\n"}) {
      const Scan scan = read(tangled(encoding, line_end));
      ASSERT_EQ(scan.positions.size(), 4U);
      EXPECT_EQ(scan.positions[0], Eigen::Vector3d(0, 0.25, 0));
      EXPECT_EQ(scan.positions[3], Eigen::Vector3d(1, 2, 5));
      ASSERT_EQ(scan.normals.size(), 4U);
      EXPECT_EQ(scan.normals[2], Eigen::Vector3f(0, 0, 1));
      ASSERT_EQ(scan.colours.size(), 4U);
      EXPECT_EQ(scan.colours[3], (Colour{13, 23, 33}));
      ASSERT_EQ(scan.triangles.size(), 2U);
      EXPECT_EQ(scan.triangles[0], (Triangle{0, 1, 2}));
      EXPECT_EQ(scan.triangles[1], (Triangle{2, 1, 3}));
      EXPECT_TRUE(scan.dropped.empty());
    }
  }
}

/// A tetrahedron with these lines for the element of its faces, and three of them.
std::string tetrahedron(const std::string& faces, const std::array<const char*, 3>& rows) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n" +
      faces + "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  for (const char* row : rows) text += std::string(row) + '\n';
  return text;
}

TEST_F(PlyTest, ReadsFacesByOtherNames) {
  const std::string list = "property list uchar int ";
  for (const std::string& faces : {"element triangle 3\n" + list + "vertex_indices\n",
                                   "element faces 3\n" + list + "vertex_index\n",
                                   "element face 3\n" + list + "Vertex_Indices\n"}) {
    const Scan scan = read(tetrahedron(faces, {"3 0 1 2", "3 0 1 3", "3 0 2 3"}));
    EXPECT_EQ(scan.triangles.size(), 3U) << faces;
    EXPECT_TRUE(scan.warnings.empty());
  }
  const Scan textured =
      read(tetrahedron("element face 3\n" + list + "tex_idx\n" + list + "vertex_idx\n",
                       {"3 3 3 3 3 0 1 2", "3 3 3 3 3 0 1 3", "3 3 3 3 3 0 2 3"}));
  ASSERT_EQ(textured.triangles.size(), 3U);
  EXPECT_EQ(textured.triangles[1], (Triangle{0, 1, 3}));
}

TEST_F(PlyTest, WarnsOfFacesThatItDoesNotUnderstand) {
  const std::string list = "property list uchar int ";
  const auto expect_warning = [&](const std::string& name, const std::string& properties,
                                  const std::array<const char*, 3>& rows) {
    const Scan scan = read(tetrahedron("element " + name + " 3\n" + properties, rows), "a.ply");
    EXPECT_TRUE(scan.triangles.empty());
    ASSERT_EQ(scan.warnings.size(), 1U) << properties;
    expect_parts(scan.warnings[0], "a.ply: header: the 3 rows of \"" + name + "\"", "cloud",
                 "\"vertex_indices\"");
  };
  expect_warning("face", list + "a\n" + list + "b\n",
                 {"1 0 3 0 1 2", "1 0 3 0 1 3", "1 0 3 0 2 3"});
  expect_warning("face", "property int v1\nproperty int v2\nproperty int v3\n",
                 {"0 1 2", "0 1 3", "0 2 3"});
  expect_warning("tetrahedra", list + "corners\n", {"4 0 1 2 3", "4 0 1 2 3", "4 0 1 2 3"});
  const Scan grid = read(tetrahedron("element range_grid 3\n" + list + "vertex_indices\n",
                                     {"1 0", "0", "1 1"}));  // of a cloud
  EXPECT_TRUE(grid.warnings.empty());
}

TEST_F(PlyTest, RefusesTwoPropertiesOfOneName) {
  const auto refusal_with = [&](const std::string& extra) {
    return refusal_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float " +
                          extra + "\nproperty float y\nproperty float z\nend_header\n1 2 3 4\n",
                      "a.ply");
  };
  expect_parts(refusal_with("X"), "a.ply: header", "\"x\" and \"X\"", "export");
  expect_parts(refusal_with("x"), "a.ply: header", "\"x\" and \"x\"", "export");
}

TEST_F(PlyTest, ReadsKeywordInCapitalsOrBehindBlankLines) {
  const std::string rest =
      "format ascii 1.0\nelement vertex 1\nproperty float a\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n9 1 2 3\n";
  for (const std::string first : {"\nply\n", "\r\n\r\n ply \r\n", "PLY\n", "Ply\ncomment c\n"}) {
    const Scan scan = read(first + rest);
    EXPECT_EQ(scan.format, "PLY ascii") << first;
    ASSERT_EQ(scan.positions.size(), 1U);
    EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1, 2, 3));
  }
  std::string table = "PLY\n";  // a title
  for (int i = 0; i < 5; ++i) table += "0.5 " + std::to_string(i * i) + ".25 1.5\n";
  EXPECT_TRUE(read(table).format.starts_with("text"));
}

TEST_F(PlyTest, ReportsEncoding) {
  EXPECT_EQ(read(tangled(Encoding::kAscii, "\n")).format, "PLY ascii");
  EXPECT_EQ(read(tangled(Encoding::kLittle, "\n")).format, "PLY binary little endian");
  EXPECT_EQ(read(tangled(Encoding::kBig, "\n")).format, "PLY binary big endian");
}

/// The reader reports the truncation or returns only complete rows.
TEST_F(PlyTest, DetectsTruncationAtEveryByte) {
  for (const Encoding encoding : kEncodings) {
    const std::string whole = tangled(encoding, "\n");
    std::size_t refused = 0;
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const auto path = write("cut.ply", std::string_view(whole).substr(0, length));
      try {
        const Scan scan = read_scan(path);
        EXPECT_EQ(scan.positions.size(), 4U) << length;
        EXPECT_EQ(scan.triangles.size(), 2U) << length;
      } catch (const ReadError& error) {
        ++refused;
        EXPECT_NE(std::string(error.what()).find("cut.ply"), std::string::npos);
      }
    }
    // Not needed: elements after the vertices and the last digits of a text.
    EXPECT_GE(refused, whole.size() - 30);
  }
}

std::string square(const std::string& faces, std::size_t count, const std::string& vertices = "") {
  const std::string corners = vertices.empty() ? "0 0 0\n1 0 0\n1 1 0\n0 1 0\n" : vertices;
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face " +
         std::to_string(count) + "\nproperty list uchar int vertex_index\nend_header\n" + corners +
         faces;
}

TEST_F(PlyTest, CountsBrokenFaces) {
  const Scan scan = read(square("3 0 1 2\n3 0 1 9\n2 0 1\n3 0 0 1\n3 -1 1 2\n0\n4 0 1 2 4\n", 7));
  EXPECT_EQ(scan.triangles.size(), 1U);
  EXPECT_EQ(dropped(scan, "face_index_out_of_range"), 3U);
  EXPECT_EQ(dropped(scan, "degenerate_face"), 3U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "6 of 7 faces", "line 15");
}

TEST_F(PlyTest, RefusesMeshOfBrokenFaces) {
  expect_parts(refusal_of(square("3 0 1 4\n3 1 2 99\n", 2), "mesh.ply"), "mesh.ply", "line 14",
               "none of the 2 faces");
}

TEST_F(PlyTest, NonFinitePointsDropFaces) {
  const Scan scan =
      read(square("3 0 1 2\n3 0 2 3\n4 0 1 2 3\n", 3, "0 0 0\nnan 0 0\n1 1 0\n0 1 -inf\n"));
  EXPECT_EQ(scan.positions.size(), 2U);
  EXPECT_TRUE(scan.triangles.empty());
  EXPECT_EQ(dropped(scan, "non_finite"), 2U);
  EXPECT_EQ(dropped(scan, "face_non_finite"), 3U);
  const Scan kept = read(square("3 0 2 3\n3 0 1 2\n", 2, "0 0 0\n1e999 0 0\n1 1 0\n0 1 0\n"));
  ASSERT_EQ(kept.triangles.size(), 1U);
  EXPECT_EQ(kept.triangles[0], (Triangle{0, 1, 2}));
}

TEST_F(PlyTest, ReadsTriangleStrips) {
  std::string text = square("9 0 1 2 3 3 2 -1 0 1\n", 1);
  text.replace(text.find("element face"), 12, "element tristrips");
  const Scan scan = read(text);
  ASSERT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(scan.triangles[1], (Triangle{2, 1, 3}));
  EXPECT_TRUE(scan.dropped.empty());
}

std::string with_colour_type(const std::string& type, const std::string& rows) {
  return "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nproperty " +
         type + " red\nproperty " + type + " green\nproperty " + type + " blue\nend_header\n" +
         rows;
}

TEST_F(PlyTest, RecognisesColourScales) {
  const Scan unit = read(with_colour_type("float", "0 0 0 0 0.5 1\n1 1 1 1 0 0\n"));
  EXPECT_EQ(unit.colours.at(0), (Colour{0, 128, 255}));
  // Only the second row shows that the scale is 0 to 255.
  const Scan bytes = read(with_colour_type("float", "0 0 0 0 1 1\n1 1 1 200 7 0\n"));
  EXPECT_EQ(bytes.colours.at(0), (Colour{0, 1, 1}));
  EXPECT_EQ(bytes.colours.at(1), (Colour{200, 7, 0}));
  const Scan words = read(with_colour_type("ushort", "0 0 0 0 257 65535\n1 1 1 514 0 0\n"));
  EXPECT_EQ(words.colours.at(0), (Colour{0, 1, 255}));
  const Scan plain = read(with_colour_type("uchar", "0 0 0 0 1 255\n1 1 1 2 0 0\n"));
  EXPECT_EQ(plain.colours.at(0), (Colour{0, 1, 255}));
}

TEST_F(PlyTest, LargestColourDecidesItsRange) {
  for (const char* type : {"ushort", "uint", "int", "float", "double"}) {
    const Scan bytes = read(with_colour_type(type, "0 0 0 1 1 0\n1 1 1 200 7 255\n"));
    EXPECT_EQ(bytes.colours.at(0), (Colour{1, 1, 0})) << type;
    EXPECT_EQ(bytes.colours.at(1), (Colour{200, 7, 255})) << type;
    const Scan words = read(with_colour_type(type, "0 0 0 1 255 0\n1 1 1 65535 514 257\n"));
    EXPECT_EQ(words.colours.at(0), (Colour{0, 1, 0})) << type;
    EXPECT_EQ(words.colours.at(1), (Colour{255, 2, 1})) << type;
  }
  const Scan beyond = read(with_colour_type("float", "0 0 0 1 0 0\n1 1 1 70000 0 0\n"));
  ASSERT_EQ(beyond.warnings.size(), 1U);
  expect_parts(beyond.warnings[0], "above 65535", "export");
}

TEST_F(PlyTest, WarnsOfColoursThatAreNotNumbers) {
  const Scan some = read(with_colour_type("float", "0 0 0 nan 0 0\n1 1 1 200 0 0\n"));
  EXPECT_EQ(some.colours.at(1), (Colour{200, 0, 0}));
  ASSERT_EQ(some.warnings.size(), 1U);
  expect_parts(some.warnings[0], "1 of 2 points", "black");
  const Scan none = read(with_colour_type("float", "0 0 0 nan 0 0\n1 1 1 nan 0 0\n"));
  EXPECT_TRUE(none.colours.empty());
  ASSERT_EQ(none.warnings.size(), 1U);
  expect_parts(none.warnings[0], "none of them is a number");
}

TEST_F(PlyTest, IgnoresIncompleteColoursAndNormals) {
  const Scan scan = read(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty uchar red\nend_header\n1 2 3 4 5\n");
  EXPECT_TRUE(scan.normals.empty());
  EXPECT_TRUE(scan.colours.empty());
}

TEST_F(PlyTest, TreatsNanNormalsAsMissing) {
  const Scan scan = read(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
      "1 2 3 nan 0 0\n4 5 6 0 1 0\n");
  EXPECT_EQ(scan.normals.at(0), Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(scan.normals.at(1), Eigen::Vector3f(0, 1, 0));
  EXPECT_EQ(scan.warnings.size(), 1U);
}

std::string header_with(const std::string& format, const std::string& count) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
}

TEST_F(PlyTest, ChecksDeclaredCounts) {
  const std::string rows = bytes_of(1.0F) + bytes_of(2.0F) + bytes_of(3.0F);
  for (const std::string count : {"4294967295", "9223372036854775807", "1000000000000"}) {
    expect_parts(refusal_of(header_with("binary_little_endian", count) + rows), count,
                 "only 1 are present", "byte ");
    expect_parts(refusal_of(header_with("ascii", count) + "1 2 3\n"), count, "only 1 are present");
  }
  expect_parts(refusal_of(header_with("ascii", "-3") + "1 2 3\n"), "negative", "line 3");
  expect_parts(refusal_of(header_with("ascii", "99999999999999999999") + "1 2 3\n"), "not a count");
  expect_parts(refusal_of(header_with("ascii", "many") + "1 2 3\n"), "many", "not a count");
  expect_parts(refusal_of(header_with("ascii", "0")), "contains no points");
}

TEST_F(PlyTest, RefusesHugeCountsAndLists) {
  const std::string vertices = header_with("binary_little_endian", "1");
  const std::string head = vertices.substr(0, vertices.find("end_header"));
  const std::string point(12, '\0');
  expect_parts(refusal_of(head +
                          "element face 4000000000\nproperty list uchar int vertex_indices\n"
                          "end_header\n" +
                          point),
               "4000000000", "\"face\"");
  expect_parts(refusal_of(head +
                          "element face 1\nproperty list int int vertex_indices\n"
                          "end_header\n" +
                          point + bytes_of(2147483647) + bytes_of(1)),
               "ends too early");
  expect_parts(refusal_of(head +
                          "element face 1\nproperty list int int vertex_indices\n"
                          "end_header\n" +
                          point + bytes_of(-5) + bytes_of(1)),
               "negative length");
}

TEST_F(PlyTest, NamesLineOfDamage) {
  expect_parts(refusal_of(header_with("ascii", "2") + "1 2 3\n1 2\n"), "line 9", "fewer values");
  expect_parts(refusal_of(header_with("ascii", "2") + "1 2 3\n1 2 three\n"), "line 9", "\"three\"");
  expect_parts(refusal_of(header_with("ascii", "2") + "1 2 3\n1 2 3 4\n"), "line 9", "more values");
  expect_parts(refusal_of(header_with("ascii", "3") + "1 2 3\n1 2 3\n"), "3 vertices", "only 2");
}

TEST_F(PlyTest, RefusesDamagedHeaders) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  expect_parts(refusal_of("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz), "end_header");
  expect_parts(refusal_of("ply\nformat text 1.0\nelement vertex 1\n" + xyz + "end_header\n1 2 3\n"),
               "\"text\"");
  expect_parts(refusal_of("ply\nelement vertex 1\n" + xyz + "end_header\n1 2 3\n"), "format line");
  expect_parts(refusal_of("ply\nformat ascii 1.0\nend_header\n"), "no element \"vertex\"");
  expect_parts(refusal_of("ply\nformat ascii 1.0\n" + xyz + "end_header\n1 2 3\n"), "line 3");
  expect_parts(refusal_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n"),
               "\"quad\"");
  expect_parts(refusal_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                          "property float y\nend_header\n1 2\n"),
               "no property \"z\"");
  expect_parts(refusal_of("ply\nformat ascii 1.0\nelement face 1\n"
                          "property list float int vertex_indices\nend_header\n"),
               "not an integer type");
}

TEST_F(PlyTest, RefusesScanAboveLimit) {
  ReadOptions options;
  options.scan_memory_bytes = 10'000;
  const auto path =
      write("big.ply", header_with("binary_little_endian", "1000") + std::string(12'000, '\0'));
  expect_parts(refusal(path, options), "big.ply", "too large", "1000 points", "Subsample");
  EXPECT_EQ(read_scan(path).positions.size(), 1000U);
}

TEST_F(PlyTest, ProgressRisesToOne) {
  std::vector<double> fractions;
  ReadOptions options;
  options.progress = [&](double fraction) { fractions.push_back(fraction); };
  const std::size_t count = 300'000;
  const auto path = write("long.ply", header_with("binary_little_endian", std::to_string(count)) +
                                          std::string(12 * count, '\0'));
  (void)read_scan(path, options);
  ASSERT_GE(fractions.size(), 3U);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1.0);
}

TEST_F(PlyTest, ReadsOldMacLineEnds) {
  std::string text = square("3 0 1 2\n", 1);
  std::replace(text.begin(), text.end(), '\n', '\r');
  EXPECT_EQ(read(text).triangles.size(), 1U);
}

TEST_F(PlyTest, WarnsOfGaussianSplats) {
  const auto header = [](const std::string& properties) {
    return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\n" +
           properties + "end_header\n";
  };
  const std::string splats =
      header("property float opacity\nproperty float scale_0\nproperty float rot_0\n");
  const std::vector<std::string> warnings = read(splats + "1 2 3 1 -6 1\n").warnings;
  ASSERT_EQ(warnings.size(), 1U);
  expect_parts(warnings[0], "Gaussian splats", "not on it");
  EXPECT_TRUE(read(header("property float opacity\n") + "1 2 3 1\n").warnings.empty());
}

}  // namespace
}  // namespace tactree::builder
