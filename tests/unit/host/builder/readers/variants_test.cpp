// Forms in which the same scan occurs: names, orders, counts, types, line ends, encodings. Each is
// read with the right values, or refused; none is read with others.

#include <functional>
#include <map>
#include <optional>
#include <sstream>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Point = Eigen::Vector3d;
using namespace std::string_literals;

constexpr int kPoints = 24;

/// No two coordinates are equal, and no axis counts the points.
Point point(int i) {
  return {10.25 + 0.5 * (i % 5), -3.125 - 0.75 * i, 100.0625 + 0.25 * (i * 7 % 11)};
}

std::string number(double value, char decimal = '.') {
  std::ostringstream out;
  out.precision(10);
  out << value;
  std::string text = out.str();
  std::replace(text.begin(), text.end(), '.', decimal);
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

enum class Must : std::uint8_t { kRead, kReadOrRefuse, kRefuse };

class VariantsTest : public TestFiles {
 protected:
  /// Reads the variant, and compares its points with `expected` and its faces with `faces`.
  void expect(const std::string& variant, const std::string& bytes, Must must = Must::kRead,
              std::size_t faces = 0, int points = kPoints) {
    std::optional<Scan> scan;
    std::string refusal;
    try {
      scan = read(bytes);
    } catch (const ReadError& error) {
      refusal = error.what();
    }
    ++variants_;
    if (!scan) {
      EXPECT_NE(must, Must::kRead) << variant << " was refused: " << refusal;
      EXPECT_EQ(refusal.back(), ')') << variant << ", no remedy: " << refusal;
      return;
    }
    EXPECT_NE(must, Must::kRefuse) << variant << " was read as " << scan->format;
    ASSERT_EQ(scan->positions.size(), static_cast<std::size_t>(points)) << variant;
    for (int i = 0; i < points; ++i) {
      const Point& p = scan->positions[static_cast<std::size_t>(i)];
      ASSERT_LT((p - point(i)).norm(), 1e-5)
          << variant << ": point " << i << " is " << p.transpose();
    }
    EXPECT_EQ(scan->triangles.size(), faces) << variant;
  }

  void TearDown() override { EXPECT_GE(variants_, 10); }

 private:
  int variants_ = 0;
};

/// With every line end, a byte order mark, and without the last line end.
std::map<std::string, std::string> line_ends(const std::string& text) {
  std::string open = text;
  open.pop_back();
  return {{"LF", text},
          {"CR LF", replaced(text, "\n", "\r\n")},
          {"CR", replaced(text, "\n", "\r")},
          {"byte order mark", "\xef\xbb\xbf" + text},
          {"no last line end", open},
          {"blank lines at the end", text + "\n \n"}};
}

std::string row(int i, const std::string& separator, char decimal = '.',
                const std::string& before = "", const std::string& after = "") {
  const Point p = point(i);
  return before + number(p.x(), decimal) + separator + number(p.y(), decimal) + separator +
         number(p.z(), decimal) + after + "\n";
}

std::string rows(const std::string& separator, char decimal = '.', const std::string& before = "",
                 const std::string& after = "") {
  std::string text;
  for (int i = 0; i < kPoints; ++i) text += row(i, separator, decimal, before, after);
  return text;
}

TEST_F(VariantsTest, ReadsSeparatorsAndLineEnds) {
  for (const std::string separator : {" ", "\t", ",", ";", ", ", " ; ", "   ", " \t"}) {
    for (const auto& [name, text] : line_ends(rows(separator))) {
      expect("separator '" + separator + "', " + name, text);
    }
    expect("separator at the end of '" + separator + "'", rows(separator, '.', "", separator));
    expect("blanks before '" + separator + "'", rows(separator, '.', "  "));
  }
}

TEST_F(VariantsTest, HandlesDecimalCommas) {
  for (const std::string separator : {";", "\t", " ", "; ", "   "}) {
    for (const auto& [name, text] : line_ends(rows(separator, ','))) {
      expect("decimal comma with '" + separator + "', " + name, text, Must::kReadOrRefuse);
    }
    expect("names and decimal comma with '" + separator + "'",
           "x" + separator + "y" + separator + "z\n" + rows(separator, ','), Must::kReadOrRefuse);
  }
  for (const std::string before : {"", "x,y,z\n", "# a scan\n", "X,Y,Z,\n"}) {
    expect("decimal comma with commas after " + before, before + rows(",", ','), Must::kRefuse);
  }
  expect("thousands", replaced(rows(";"), "100.", "1,00."), Must::kReadOrRefuse);
}

TEST_F(VariantsTest, ReadsColumnNames) {
  for (const std::string names :
       {"x,y,z", "X,Y,Z", "\"x\",\"y\",\"z\"", "//X,Y,Z", "# x,y,z", "#X,Y,Z", "% x,y,z", "; x,y,z",
        "x [m],y [m],z [m]", "X(m),Y(m),Z(m)", "Easting,Northing,Elevation", "E,N,H",
        "easting,northing,height", "pos_x,pos_y,pos_z", "Points:0,Points:1,Points:2", "x,y,z,",
        "PosX,PosY,PosZ", "X Coordinate,Y Coordinate,Z Coordinate", "x_m,y_m,z_m"}) {
    expect("names " + names, names + "\n" + rows(","), Must::kReadOrRefuse);
  }
  // Names that are not in the order x, y, z.
  for (const std::string names :
       {"z,x,y", "Z,X,Y", "# z,x,y", "//Z,X,Y", "Elevation,Easting,Northing"}) {
    std::string text = names + "\n";
    for (int i = 0; i < kPoints; ++i) {
      const Point p = point(i);
      text += number(p.z()) + "," + number(p.x()) + "," + number(p.y()) + "\n";
    }
    expect("names " + names, text, Must::kReadOrRefuse);
  }
}

TEST_F(VariantsTest, ReadsCommentsQuotesAndExponents) {
  for (const char* const comment : {"#", "//", "%", ";", "!", "--"}) {
    expect("comment "s + comment, comment + " a scan, of 2024\n"s + comment + "\n" + rows(" "),
           Must::kReadOrRefuse);
  }
  expect("quoted numbers", replaced("\"" + rows("\",\""), "\n", "\"\n\""), Must::kReadOrRefuse);
  expect("signs", replaced(rows(" "), "10", "+10"), Must::kReadOrRefuse);
  expect("exponents", replaced(rows(" "), ".0625", ".0625e+00"));
  expect("exponents of Fortran", replaced(rows(" "), ".0625", ".0625D+00"), Must::kReadOrRefuse);
  expect("blank lines", replaced(rows(" "), "\n", "\n\n"));
  expect("brackets", replaced(replaced(rows(" "), "10.25", "(10.25"), "\n", ")\n"),
         Must::kReadOrRefuse);
  expect("units", rows(" ", '.', "", " m"), Must::kReadOrRefuse);
  std::string wide("\xff\xfe");
  for (const char c : rows(" ")) wide += {c, '\0'};
  expect("UTF-16", wide, Must::kReadOrRefuse);
}

TEST_F(VariantsTest, ReadsPointNumbers) {
  for (const int first : {0, 1, 1000}) {
    for (const char* const letter : {"", "P", "pt_"}) {
      for (const std::string separator : {",", " ", "\t"}) {
        std::string text;
        for (int i = 0; i < kPoints; ++i) {
          text += row(i, separator, '.', letter + std::to_string(first + i) + separator);
        }
        expect("number " + (letter + std::to_string(first)) + " and '" + separator + "'", text,
               *letter == '\0' ? Must::kRead : Must::kReadOrRefuse);
        expect("the same with a code", replaced(text, "\n", separator + "TREE\n"),
               Must::kReadOrRefuse);
      }
    }
  }
}

TEST_F(VariantsTest, ReadsCountsBeforeTables) {
  const auto with_count = [](int count, const std::string& after) {
    return std::to_string(count) + "\n" + rows(" ", '.', "", after);
  };
  for (const std::string after : {"", " 12", " -1200 10 20 30", " 0.5 10 20 30", " 10 20 30"}) {
    expect("count, then rows with '" + after + "'", with_count(kPoints, after));
    expect("no count, rows with '" + after + "'", rows(" ", '.', "", after));
    expect("a count too small", with_count(kPoints - 4, after), Must::kReadOrRefuse, 0, kPoints);
    expect("a count too large", with_count(kPoints + 4, after), Must::kReadOrRefuse);
  }
}

std::string ply(const std::string& format, const std::string& declared,
                const std::function<std::string(int)>& vertex, const std::string& more = "",
                const std::string& body = "") {
  std::string text = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(kPoints) +
                     "\n" + declared + more + "end_header\n";
  for (int i = 0; i < kPoints; ++i) text += vertex(i);
  return text + body;
}

TEST_F(VariantsTest, ReadsTextPly) {
  const std::string xyz = "property T x\nproperty T y\nproperty T z\n";
  const auto ascii = [](int i) { return row(i, " "); };
  for (const auto& [name, text] : line_ends(ply("ascii", replaced(xyz, "T", "float"), ascii))) {
    expect("text, " + name, text, name == "CR" ? Must::kReadOrRefuse : Must::kRead);
  }
  expect("capitals", replaced(ply("ascii", replaced(xyz, "T", "float"), ascii), " x", " X"),
         Must::kReadOrRefuse);
  expect("decimal comma",
         ply("ascii", replaced(xyz, "T", "float"), [](int i) { return row(i, " ", ','); }),
         Must::kRefuse);
  for (const char* const name : {"vertex_indices", "vertex_index", "vertex_indexes", "indices"}) {
    const std::string face = "element face 2\nproperty list uchar int "s + name + "\n";
    expect("faces "s + name,
           ply("ascii", replaced(xyz, "T", "double"), ascii, face, "3 0 1 2\n4 0 1 2 3\n"),
           Must::kRead, 3);
  }
}

std::string obj_vertices(const std::string& after = "") {
  std::string text;
  for (int i = 0; i < kPoints; ++i) text += row(i, " ", '.', "v ", after);
  return text;
}

TEST_F(VariantsTest, ReadsObjFaces) {
  const char* const kForms[] = {"f 1 2 3\nf 2 3 4\n",
                                "f 1/1 2/2 3/3\nf 2/1 3/1 4/1\n",
                                "f 1//1 2//2 3//3\nf 2//1 3//1 4//1\n",
                                "f 1/1/1 2/2/2 3/3/3\nf 2/1/1 3/1/1 4/1/1\n",
                                "f -24 -23 -22\nf -23 -22 -21\n",
                                "f 1 2 \\\n 3\nf 2 3 4\n",
                                "f  1\t2 3 \nf 2 3 4 # a face\n",
                                "g a\nusemtl m\ns 1\nf 1 2 3\no b\nf 2 3 4\n",
                                "f 1 2 4 3\n",
                                "fo 1 2 3\nf 2 3 4\n"};
  for (const char* const form : kForms) {
    for (const std::string after : {"", " 1.0", " 0.5 0.5 0.5"}) {
      for (const auto& [name, text] : line_ends(obj_vertices(after) + form)) {
        expect("OBJ with "s + form + after + ", " + name, text, Must::kReadOrRefuse, 2);
      }
    }
  }
  for (const auto& [name, text] : line_ends(obj_vertices() + "f 1 2 3\n")) {
    expect("OBJ, " + name, text, Must::kRead, 1);
  }
  expect("capitals", replaced(obj_vertices(), "v ", "V ") + "F 1 2 3\n", Must::kReadOrRefuse, 1);
  expect("decimal comma", replaced(obj_vertices() + "f 1 2 3\n", ".", ","), Must::kRefuse);
}

TEST_F(VariantsTest, ReadsOffCounts) {
  const std::string body = rows(" ") + "3 0 1 2\n4 0 1 2 3\n";
  for (const std::string head :
       {"OFF\n24 2 0\n", "OFF 24 2 0\n", "OFF\n# a comment\n24 2 0\n", "OFF # a comment\n24 2 0\n",
        "OFF\n\n24 2 0\n", "OFF\n24 2\n", "OFF\n24\t2\t5 \n", "off\n24 2 0\n",
        "# first\nOFF\n24 2 0\n", "OFF\n24 2 0 # counts\n"}) {
    for (const auto& [name, text] : line_ends(head + body)) {
      expect("OFF " + head + name, text, Must::kReadOrRefuse, 3);
    }
  }
  for (const auto& [name, text] : line_ends("OFF\n24 2 0\n" + body)) {
    expect("OFF, " + name, text, Must::kRead, 3);
  }
  const std::string coloured = rows(" ", '.', "", " 255 0 0 255");
  expect("COFF", "COFF\n24 2 0\n" + coloured + "3 0 1 2\n4 0 1 2 3\n", Must::kRead, 3);
  expect("colours of faces",
         "OFF\n24 2 0\n" + rows(" ") + "3 0 1 2 255 0 0\n4 0 1 2 3 0.5 0.5 0.5\n", Must::kRead, 3);
}

/// Triangles over three points each, in their order.
std::string stl_text(const std::string& first, const std::string& last) {
  std::string text = first + "\n";
  for (int i = 0; i < kPoints; i += 3) {
    text += "facet normal 0 0 1\n outer loop\n" + row(i, " ", '.', "  vertex ") +
            row(i + 1, " ", '.', "  vertex ") + row(i + 2, " ", '.', "  vertex ") +
            " endloop\nendfacet\n";
  }
  return last.empty() ? text : text + last + "\n";
}

std::string stl_binary(const std::string& header, std::optional<std::uint32_t> count,
                       const std::string& after = "") {
  std::string bytes = header;
  bytes.resize(80, ' ');
  if (count) bytes += bytes_of(*count);
  for (int i = 0; i < kPoints; i += 3) {
    bytes += std::string(12, '\0');
    for (int k = i; k < i + 3; ++k) {
      const Eigen::Vector3f p = point(k).cast<float>();
      bytes += bytes_of(p.x()) + bytes_of(p.y()) + bytes_of(p.z());
    }
    bytes += "\x11\x22";
  }
  return bytes + after;
}

TEST_F(VariantsTest, ReadsStlKeywordsAndCounts) {
  constexpr std::size_t kFaces = kPoints / 3;
  for (const std::string first : {"solid", "solid a", "solid a b 1 2 3", "SOLID A",
                                  "solid ascii\tx", "solid a facet normal part"}) {
    for (const std::string last :
         {"endsolid", "endsolid a", "end solid", "ENDSOLID", "end solid a b"}) {
      for (const auto& [name, text] : line_ends(stl_text(first, last))) {
        expect("STL " + first + last + name, text, Must::kRead, kFaces);
      }
    }
  }
  const std::string plain = stl_text("solid a", "endsolid a");
  expect("STL in capitals",
         replaced(replaced(replaced(plain, "facet normal", "FACET NORMAL"), "vertex", "VERTEX"),
                  "outer loop", "OUTER LOOP"),
         Must::kRead, kFaces);
  expect("STL on one line", replaced(plain, "\n", " ") + "\n", Must::kReadOrRefuse, kFaces);
  expect("STL with tabs", replaced(plain, "  vertex ", "\tvertex\t"), Must::kRead, kFaces);
  expect("STL without end", stl_text("solid a", ""), Must::kReadOrRefuse, kFaces);
  expect("two solids", replaced(plain, "endsolid a", "endsolid a\nsolid b\nendsolid b"),
         Must::kRead, kFaces);
  expect("STL with a decimal comma", replaced(plain, ".", ","), Must::kRefuse);
  for (const std::string header : {"", "solid a", "COLOR=\1\2\3\4", "GIF8", "LASF", "v 1 2 3\n"}) {
    expect("binary STL, header " + header, stl_binary(header, kFaces), Must::kRead, kFaces);
    expect("binary STL, count 0, header " + header, stl_binary(header, 0), Must::kReadOrRefuse,
           kFaces);
    expect("binary STL, no count, header " + header, stl_binary(header, {}), Must::kReadOrRefuse,
           kFaces);
    expect("binary STL, bytes after it, header " + header, stl_binary(header, kFaces, "end"),
           Must::kReadOrRefuse, kFaces);
  }
}

std::string pcd(const std::string& fields, const std::string& extra, const std::string& body,
                const std::string& counts = "") {
  const auto columns = std::count(fields.begin(), fields.end(), ' ') + 1;
  std::string sizes;
  std::string types;
  for (long i = 0; i < columns; ++i) {
    sizes += " 4";
    types += " F";
  }
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE" +
         sizes + "\nTYPE" + types + "\n" + counts + extra + "DATA ascii\n" + body;
}

TEST_F(VariantsTest, ReadsPcdHeaders) {
  for (const std::string extra :
       {"WIDTH 24\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 24\n",
        "WIDTH 24\nHEIGHT 1\nPOINTS 24\n", "WIDTH 24\nHEIGHT 1\n", "WIDTH 6\nHEIGHT 4\nPOINTS 24\n",
        "POINTS 24\n", "WIDTH 24\nHEIGHT 1\nPOINTS 24\n# a comment\n",
        "WIDTH  24\nHEIGHT\t1\nPOINTS 24 \n"}) {
    for (const auto& [name, text] : line_ends(pcd("x y z", extra, rows(" ")))) {
      expect("PCD " + extra + name, text, Must::kReadOrRefuse);
    }
    expect("PCD with counts, " + extra, pcd("x y z", extra, rows(" "), "COUNT 1 1 1\n"));
    expect("PCD with more fields, " + extra, pcd("a x y z b", extra, rows(" ", '.', "5 ", " nan")));
  }
  expect("PCD with a decimal comma",
         pcd("x y z", "WIDTH 24\nHEIGHT 1\nPOINTS 24\n", rows(" ", ',')), Must::kRefuse);
}

}  // namespace
}  // namespace tactree::builder
