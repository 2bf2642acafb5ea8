// The columns of text files without names: guessed only if they look like points.

#include <functional>
#include <stdexcept>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;

class TextColumnsTest : public TestFiles {};

/// Points of a bent sheet, with text before and after each.
using Field = std::function<std::string(int)>;
std::string table(int count, const Field& before, const Field& after, const char* separator = " ") {
  std::string text;
  for (int i = 0; i < count; ++i) {
    const double x = 0.011 * (i % 17);
    const double y = 0.013 * (i * 7 % 19) - 0.1;
    text += before(i) + std::to_string(x) + separator + std::to_string(y) + separator +
            std::to_string(0.3 + x * y) + after(i) + "\n";
  }
  return text;
}

std::string nothing(int) { return ""; }

std::string note_of(const Scan& scan) { return scan.notes.empty() ? "" : scan.notes.front(); }

TEST_F(TextColumnsTest, SkipsConsecutiveNumberColumn) {
  const Scan scan = read(table(
      200, [](int i) { return std::to_string(1000 + i) + ","; }, nothing, ","));
  ASSERT_EQ(scan.positions.size(), 200U);
  EXPECT_NEAR(scan.positions[1].x(), 0.011, 1e-9);
  EXPECT_NEAR(scan.positions[1].z(), 0.3 + 0.011 * (0.013 * 7 - 0.1), 1e-6);
  expect_parts(note_of(scan), "x=2, y=3, z=4", "column 1 numbers the points", "x=3,y=2,z=4");
  EXPECT_TRUE(scan.warnings.empty());
}

TEST_F(TextColumnsTest, AcceptsGapsInPointNumbers) {
  const Scan scan = read(table(
      200, [](int i) { return std::to_string(i + i / 50) + " "; },
      [](int) { return " 20 30 200 tree"; }));
  expect_parts(note_of(scan), "x=2, y=3, z=4, red=5, green=6, blue=7", "column 1 numbers");
  EXPECT_EQ(scan.colours.at(7), (Colour{20, 30, 200}));
}

TEST_F(TextColumnsTest, RefusesCountsLikeNumberedRows) {
  const auto number = [](int i) { return std::to_string(7 + i) + " "; };
  expect_parts(refusal_of("830 3 0 0\n" + table(50, number, nothing)), "line 1",
               "column 1 numbers the rows from the second row on");
  EXPECT_EQ(read("6 0 1 0\n" + table(50, number, nothing)).positions.size(), 51U);
  EXPECT_EQ(read("2 0.5 0.25 0.125\n" + table(50, number, nothing)).positions.size(), 51U);
}

TEST_F(TextColumnsTest, RefusesPossibleTimeColumn) {
  expect_parts(refusal_of(table(
                   100, [](int i) { return std::to_string(i * i) + " "; }, nothing)),
               "line 1", "column 1 rises", "--columns x=1,y=2,z=3");
}

TEST_F(TextColumnsTest, RefusesAmbiguousCounterColumn) {
  std::string line;
  for (int i = 0; i < 2000; ++i) line += std::to_string(i) + " 5 0.25 100\n";
  expect_parts(refusal_of(line), "may number the points, or be a coordinate");
  // It begins like numbers and then starts again: a raster with a wide row.
  std::string raster;
  for (int i = 0; i < 6000; ++i) {
    raster += std::to_string(i % 1500) + " " + std::to_string(0.001 * i) + " " +
              std::to_string(0.25 + 0.001 * (i % 7)) + " " + std::to_string(0.1 * (i % 11)) + "\n";
  }
  EXPECT_EQ(read(raster.substr(0, raster.find("\n0 "))).positions.size(), 1500U);
  std::string restarts = raster.substr(0, raster.find("\n0 ") + 1);
  for (int i = 0; i < 100; ++i) restarts += "0 0.1 0.2 0.3\n";
  expect_parts(refusal_of(restarts), "line 1501", "100 of 1600", "may be a coordinate");
}

TEST_F(TextColumnsTest, RefusesNumberWithTwoCoordinates) {
  std::string text;
  for (int i = 0; i < 20; ++i) {
    text += std::to_string(i) + " " + std::to_string(0.013 * (i * 7 % 19)) + " 0.7" +
            std::to_string(i * 3 % 10) + "\n";
  }
  expect_parts(refusal_of(text), "column 1 numbers the rows, and only two columns follow");
}

TEST_F(TextColumnsTest, RefusesFaces) {
  std::string faces;
  for (int i = 0; i < 30; ++i) {
    faces += "3 " + std::to_string(i * 5 % 13) + " " + std::to_string(i * 3 % 11) + " 7\n";
  }
  expect_parts(refusal_of(faces),
               "every row consists of 3 and other integers, like the faces of a mesh");
}

TEST_F(TextColumnsTest, RefusesHeightGrids) {
  const auto grid = [](int columns) {
    std::string text;
    for (int row = 0; row < 40; ++row) {
      for (int i = 0; i < columns; ++i) {
        text += std::to_string(0.02 + 0.0001 * i + 0.001 * (row % 13)) + " ";
      }
      text += "\n";
    }
    return text;
  };
  expect_parts(refusal_of(grid(5)), "hardly differ, as in a grid of heights");
  expect_parts(refusal_of(grid(8)), "hardly differ, as in a grid of heights");
  expect_parts(refusal_of(grid(60)), "57 columns are neither normals nor colours");
}

TEST_F(TextColumnsTest, RefusesRowsOfDifferentLength) {
  const std::string ragged = table(100, nothing, [](int i) {
    std::string more;
    for (int k = 0; k < i % 4; ++k) more += " 0.5 0.25 0.125";
    return more;
  });
  expect_parts(refusal_of(ragged), "the rows differ in their number of columns", "--columns");
  expect_parts(refusal_of("12 40 7 1 2\n" + table(100, nothing, nothing)), "line 1",
               "the first row has integers and differs in length");
  expect_parts(refusal_of("100 3\n" + table(100, nothing, nothing)), "line 1", "\"100 3\"",
               "the counts of a mesh");
}

TEST_F(TextColumnsTest, AcceptsSpacesInTrailingWords) {
  const Scan scan =
      read(table(100, nothing, [](int i) { return i % 3 == 0 ? " a b c" : " tree"; }));
  EXPECT_EQ(scan.positions.size(), 100U);
  expect_parts(note_of(scan), "x=1, y=2, z=3");
}

TEST_F(TextColumnsTest, RequiresOnlyUsedColumns) {
  const Scan scan = read("# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D)\n" +
                         table(
                             100, [](int i) { return std::to_string(900 - 7 * i) + " "; },
                             [](int i) {
                               std::string more = " 20 30 200 0.9";
                               for (int k = 0; k < i % 5; ++k) more += " 37 1073";
                               return more;
                             }));
  EXPECT_EQ(scan.positions.size(), 100U);
  EXPECT_EQ(scan.colours.at(99), (Colour{20, 30, 200}));
  EXPECT_TRUE(scan.dropped.empty());
  expect_parts(note_of(scan), "x=2, y=3, z=4, red=5", "named by line 1");
}

TEST_F(TextColumnsTest, ReadsPtsWithoutCount) {
  const auto colours = [this](const std::string& rest) {
    return read(table(100, nothing, [&](int i) { return " " + std::to_string(i % 200) + rest; }))
        .colours.at(1);
  };
  EXPECT_EQ(colours(" 220 20 30"), (Colour{220, 20, 30}));
  EXPECT_EQ(colours(" 255 255 255"), (Colour{255, 255, 255}));
  // An opacity, not an intensity.
  EXPECT_EQ(colours(" 20 30 255"), (Colour{1, 20, 30}));
  const Scan reflectance = read(table(100, nothing, [](int) { return " -1035 220 20 30"; }));
  EXPECT_EQ(reflectance.colours.at(1), (Colour{220, 20, 30}));
}

TEST_F(TextColumnsTest, RecognisesSurveyNames) {
  const Scan scan = read("Point#,Northing,Easting,Elevation,Code\n1,2,3,4,a\n2,5,6,7,b\n");
  ASSERT_EQ(scan.positions.size(), 2U);
  EXPECT_EQ(scan.positions[1], Eigen::Vector3d(6, 5, 7));
  expect_parts(note_of(scan), "x=3, y=2, z=4", "named by line 1");
  // A column N beside x y z is no coordinate.
  EXPECT_EQ(read("n,x,y,z\n1,2,3,4\n").positions.at(0), Eigen::Vector3d(2, 3, 4));
}

TEST_F(TextColumnsTest, UsesColumnsNamedByUser) {
  const auto path = write("a.csv", "label;north;east;up\nA;1,5;2;3\nB;4;5;6\n");
  const Scan scan = read_scan(path, columns("x=3, y=2, z=4"));
  ASSERT_EQ(scan.positions.size(), 2U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(2, 1.5, 3));
  expect_parts(note_of(scan), "x=3, y=2, z=4", "as named");
  expect_parts(refusal(write("b.csv", "1 2 3\n4 5 6\n"), columns("x=2,y=3,z=4")), "line 1",
               "3 values", "--columns");
}

std::string refusal_of_columns(const char* text) {
  return test::message_of<std::invalid_argument>([&] { (void)parse_columns(text); });
}

TEST(ParseColumns, AcceptsCompleteTriples) {
  EXPECT_EQ(parse_columns("x=2,y=3,z=4"), (ColumnMap{{"x", 2}, {"y", 3}, {"z", 4}}));
  EXPECT_EQ(parse_columns("X=1, Y=2, Z=3, r=4, g=5, b=6").at("blue"), 6U);
}

TEST(ParseColumns, RefusesEverythingElse) {
  expect_parts(refusal_of_columns("x=2,y=3"), "x, y and z are needed", "x=2,y=3,z=4");
  expect_parts(refusal_of_columns("x=1,y=2,z=3,nx=4"), "nx, ny and nz are needed");
  expect_parts(refusal_of_columns("x=0,y=1,z=2"), "'x=0'");
  expect_parts(refusal_of_columns("x=1,y=2,z=9999999999"), "'z=9999999999'");
  expect_parts(refusal_of_columns("x=1,y=2,w=3"), "'w=3'");
  expect_parts(refusal_of_columns("x=1,y=2,z"), "'z'");
  expect_parts(refusal_of_columns("x=1,y=2,z=3,"), "''");
  expect_parts(refusal_of_columns("x=1,y=2,z=2"), "'z=2' names a column twice");
  expect_parts(refusal_of_columns("x=1,y=2,z=3,x=4"), "'x=4' names a column twice");
}

}  // namespace
}  // namespace tactree::builder
