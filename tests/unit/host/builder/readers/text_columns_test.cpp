// The columns of text files without names: guessed only if they look like points.

#include <fmt/format.h>

#include <cmath>
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

TEST_F(TextColumnsTest, RefusesTimeOfSeveralPoints) {
  const auto time = [](int beams, int jitter) {
    return table(
        200,
        [=](int i) {
          return std::to_string(414560.12 + 1e-4 * (i / beams) + 1e-6 * (i * i % jitter)) + " ";
        },
        nothing);
  };
  expect_parts(refusal_of(time(16, 1)), "column 1 never falls", "--columns x=1,y=2,z=3");
  expect_parts(refusal_of(time(1, 50)), "column 1 never falls");
  // Sorted by x, with an intensity.
  std::string sorted;
  for (int i = 0; i < 200; ++i) {
    sorted += std::to_string(0.01 * (i / 10)) + " " + std::to_string(0.01 * (i % 10)) + " " +
              std::to_string(0.001 * (i * i % 70)) + " " + std::to_string(100 + i % 30) + "\n";
  }
  EXPECT_EQ(read(sorted).positions.size(), 200U);
}

TEST_F(TextColumnsTest, RefusesDegrees) {
  std::string text;
  for (int i = 0; i < 100; ++i) {
    text += fmt::format("{:.9f} {:.9f} {:.3f}\n", 11.5 + 1e-6 * (i % 10), 48.1 + 1e-6 * (i / 10),
                        500.0 + 0.001 * (i * i % 70));
  }
  expect_parts(refusal_of(text), "longitude, latitude and height", "project them");
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

std::string decimal(double value) { return std::to_string(value); }

TEST_F(TextColumnsTest, RefusesNumbersBeforePositions) {
  const auto refused = [this](const Field& before, const std::string& cause) {
    expect_parts(refusal_of(table(200, before, nothing)), cause, "--columns x=1,y=2,z=3");
  };
  refused([](int i) { return std::to_string(500 - i) + " "; }, "column 1 falls");
  refused([](int i) { return std::to_string(i % 40) + " "; }, "column 1 has whole numbers");
  refused([](int) { return "7 "; }, "column 1 has whole numbers");
  refused([](int i) { return std::to_string(i / 40) + " " + std::to_string(i % 40) + " "; },
          "columns 1 to 2 have whole numbers");
  refused([](int i) { return std::to_string(i % 7) + " 200 " + std::to_string(i % 40) + " "; },
          "columns 1 to 3 have whole numbers");
  refused([](int i) { return decimal(1.7e9 + 0.25 * i) + " "; }, "like a time");
  refused([](int i) { return decimal(100.125 - 0.5 * i) + " "; }, "like a time");
  refused([](int i) { return decimal(std::sin(i)) + " 0 " + decimal(std::cos(i)) + " "; },
          "unit vectors, like normals before x, y and z");
  refused([](int) { return "1 0 0 "; }, "two of the first three columns are constant");
}

/// Whole numbers and regular steps that are coordinates.
TEST_F(TextColumnsTest, ReadsRegularCoordinates) {
  std::string heights;
  std::string raster;
  std::string sphere;
  for (int i = 0; i < 900; ++i) {
    const std::string grid = std::to_string(i % 30) + " " + std::to_string(i / 30) + " ";
    heights += grid + decimal(3.0 + std::sin(0.2 * i)) + "\n";
    raster += decimal(0.001 * i) + " 0.25 " + decimal(0.01 * std::sin(0.1 * i)) + " 5\n";
    const double z = 1.0 - (2.0 * i + 1.0) / 900.0;
    const double r = std::sqrt(1.0 - z * z);
    sphere += std::to_string(std::lround(100 + 90 * r * std::cos(2.4 * i))) + " " +
              std::to_string(std::lround(100 + 90 * r * std::sin(2.4 * i))) + " " +
              std::to_string(std::lround(100 + 90 * z)) + "\n";
  }
  for (const std::string& text : {heights, raster, sphere}) {
    const Scan scan = read(text);
    EXPECT_EQ(scan.positions.size(), 900U);
    expect_parts(note_of(scan), "x=1, y=2, z=3");
  }
}

/// The triangles of a grid of `size` x `size` points.
std::string triangles(int size, const Field& before, int first) {
  std::string text;
  for (int i = 0, row = 0; i < size * (size - 1); ++i) {
    if (i % size == size - 1) continue;
    const int a = first + i;
    const int b = a + size;
    text += before(row++) + std::to_string(a) + " " + std::to_string(b) + " " +
            std::to_string(b + 1) + "\n";
    text += before(row++) + std::to_string(a) + " " + std::to_string(b + 1) + " " +
            std::to_string(a + 1) + "\n";
  }
  return text;
}

TEST_F(TextColumnsTest, RefusesConnectivity) {
  const auto number = [](int i) { return std::to_string(i + 1) + " "; };
  for (const Field& before : {Field(nothing), Field(number)}) {
    for (const int first : {0, 1}) {
      expect_parts(refusal_of(triangles(20, before, first)), "like the corners of the faces");
    }
  }
  // Tetrahedra around the edges of a row of cubes.
  std::string cells;
  for (int i = 0; i < 200; i += 4) {
    constexpr int kCells[6][4] = {{0, 1, 3, 7}, {0, 1, 7, 5}, {0, 5, 7, 4},
                                  {0, 3, 2, 7}, {0, 6, 4, 7}, {0, 2, 6, 7}};
    for (const auto& cell : kCells) {
      for (const int corner : cell) cells += std::to_string(i + corner) + " ";
      cells += "\n";
    }
  }
  expect_parts(refusal_of(cells), "like the corners of the faces");
}

TEST_F(TextColumnsTest, RefusesFacesAfterPoints) {
  const std::string points = table(100, nothing, nothing);
  for (const std::string between : {"", "162\n"}) {
    expect_parts(refusal_of(points + between + triangles(10, nothing, 0)), "the last 162 rows",
                 "may be the faces of a mesh", between.empty() ? "line 101" : "line 102");
  }
  EXPECT_EQ(read_scan(write("named", points + triangles(10, nothing, 0)), columns("x=1,y=2,z=3"))
                .positions.size(),
            262U);
  EXPECT_EQ(read(points + "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n").positions.size(), 105U);
  EXPECT_EQ(read(points + "1 2 3\n").positions.size(), 101U);
}

TEST_F(TextColumnsTest, RefusesCountsOfSameWidth) {
  expect_parts(refusal_of("10 10 1\n" + table(100, nothing, nothing)), "line 1",
               "the first row alone consists of whole numbers");
  EXPECT_EQ(read("0 0 0\n" + table(100, nothing, nothing)).positions.size(), 101U);
}

TEST_F(TextColumnsTest, RefusesPicturesAndNarrowGrids) {
  const auto grid = [](int columns, double scale) {
    std::string text;
    for (int i = 0; i < 40 * columns; ++i) {
      const double height = 120 + 100 * std::sin(0.1 * (i / columns)) + 2 * (i % columns);
      text += scale == 1.0 ? std::to_string(std::lround(height)) : decimal(scale * height);
      text += i % columns == columns - 1 ? "\n" : " ";
    }
    return text;
  };
  expect_parts(refusal_of(grid(4, 0.001)), "as in a grid of heights");
  expect_parts(refusal_of(grid(6, 1.0)), "as in a grid of heights");
  expect_parts(refusal_of(grid(12, 1.0)), "all 12 columns consist of whole numbers");
}

TEST_F(TextColumnsTest, ReportsColoursThatMayBeOthers) {
  const auto text = [](const char* after) {
    return table(100, nothing, [=](int i) { return " " + std::to_string(i % 7) + after; });
  };
  const Scan classes = read(text(" 1 3"));
  EXPECT_TRUE(classes.colours.empty());
  ASSERT_EQ(classes.warnings.size(), 1U);
  expect_parts(classes.warnings[0], "Columns 4 to 6 were ignored", "red=4,green=5,blue=6");
  const Scan intensity = read(text(" 200 3 90"));
  EXPECT_EQ(intensity.colours.at(1), (Colour{200, 3, 90}));
  expect_parts(note_of(intensity), "red=5, green=6, blue=7", "column 4 is taken for an intensity");
}

TEST_F(TextColumnsTest, ReadsCommentsOfOtherPrograms) {
  for (const std::string sign : {"%", "!"}) {
    std::string text;
    for (int i = 0; i < 30; ++i) text += sign + " a comment, of 30\n";
    const Scan scan = read(text + sign + " z, x, y\n" + table(100, nothing, nothing, ","));
    EXPECT_EQ(scan.positions.size(), 100U);
    EXPECT_TRUE(scan.warnings.empty());
    expect_parts(note_of(scan), "x=2, y=3, z=1");
  }
}

TEST_F(TextColumnsTest, TakesNoCountAfterTitle) {
  const Scan scan = read("a title\n3\nx of it\n" + table(100, nothing, nothing));
  EXPECT_EQ(scan.positions.size(), 100U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "3 lines before the first row were skipped");
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
