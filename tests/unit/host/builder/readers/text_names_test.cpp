// Lines of column names: they must fit the rows, and may state a unit. What a name or a row may
// look like otherwise.

#include "text_names.hpp"

#include <fmt/format.h>

#include <functional>

#include "test_files.hpp"
#include "unit_names.hpp"

namespace tactree::builder {
namespace {

class TextNamesTest : public TestFiles {
 protected:
  /// Expects the bent sheet of rows() with its right coordinates.
  void expect_sheet(const std::string& bytes, double scale = 1.0) {
    const Scan scan = read(bytes);
    ASSERT_EQ(scan.positions.size(), kRows);
    for (std::size_t i = 0; i < kRows; ++i) {
      EXPECT_NEAR((scan.positions[i] - scale * point(i)).norm(), 0.0, 1e-9) << i;
    }
  }
  static Eigen::Vector3d point(std::size_t i) {
    const double x = 0.011 * static_cast<double>(i % 17);
    const double y = 0.013 * static_cast<double>(i * 7 % 19) - 0.1;
    return {x, y, 0.25 + x * y};
  }
  /// Rows in which {x}, {y}, {z} and {i} stand for the coordinates and the number of a point.
  static std::string rows(std::string_view row) {
    std::string text;
    for (std::size_t i = 0; i < kRows; ++i) {
      const Eigen::Vector3d p = point(i);
      text += fmt::format(fmt::runtime(row), fmt::arg("x", p.x()), fmt::arg("y", p.y()),
                          fmt::arg("z", p.z()), fmt::arg("i", i + 1));
      text += '\n';
    }
    return text;
  }
  static constexpr std::size_t kRows = 100;
};

TEST_F(TextNamesTest, SkipsLabelBeforeNames) {
  expect_sheet("# Format: x y z intensity\n" + rows("{x} {y} {z} 0.5"));
  expect_sheet("Columns: x, y, z, i\n" + rows("{x},{y},{z},120"));
  expect_sheet("# Format: X Y Z R G B\n" + rows("{x} {y} {z} 200 100 50"));
}

TEST_F(TextNamesTest, KeepsNamesWithSpacesBetweenTabs) {
  expect_sheet("Point ID\tX\tY\tZ\tReflectance\n" + rows("{i}\t{x}\t{y}\t{z}\t0.5"));
  expect_sheet("\"Point ID\" \"X\" \"Y\" \"Z\"\n" + rows("{i} {x} {y} {z}"));
  expect_sheet("id\tcode\tx\ty\tz\n" + rows("{i}\t\t{x}\t{y}\t{z}"));
  expect_sheet("x y z\n" + rows("{x} {y} {z}\t7 8 9"));
}

TEST_F(TextNamesTest, SkipsUnnamedNumbersOfRows) {
  expect_sheet("x,y,z\n" + rows("{i},{x},{y},{z}"));
  expect_sheet("\"x\" \"y\" \"z\"\n" + rows("\"{i}\" {x} {y} {z}"));
  expect_sheet(" z y x\n" + rows("{i} {z} {y} {x}"));
  expect_parts(read("x,y,z\n" + rows("{i},{x},{y},{z}")).notes.at(0),
               "x=2, y=3, z=4, named by line 1, after the numbers of the rows");
}

TEST_F(TextNamesTest, RefusesNamesThatDoNotFitRows) {
  expect_parts(refusal_of("Point ID X Y Z Intensity\n" + rows("{i} {x} {y} {z} 0.5")), "line 1",
               "6 names of columns, but the rows have 5", "--columns x=2,y=3,z=4");
  expect_parts(refusal_of("id x y z\n" + rows("9 7.5 {x} {y} {z}")), "4 names");
  // Names of the first columns, a list or words at the end of the rows.
  expect_sheet("x y z\n" + rows("{x} {y} {z} 0.5 0.25"));
  expect_sheet("id x y z name\n" + rows("{i} {x} {y} {z} old oak tree"));
}

TEST_F(TextNamesTest, RefusesNameGivenTwice) {
  expect_parts(refusal_of("x,y,X,Y,Z\n" + rows("342.5,947.25,{x},{y},{z}")), "line 1",
               "columns 1 and 3 are both named x");
}

TEST_F(TextNamesTest, RefusesOtherNamesAfterRows) {
  const std::string text = "x,y,z,i\n" + rows("{x},{y},{z},120");
  expect_parts(refusal_of(text + "y,x,z,i\n" + rows("{y},{x},{z},120")), "line 102",
               "x=2, y=1, z=3", "split the file");
  EXPECT_EQ(read(text + text).positions.size(), 2 * kRows);
  EXPECT_TRUE(read(text + text).warnings.empty());
}

TEST_F(TextNamesTest, TakesNoNamesFromStatements) {
  expect_sheet("# scanner position: x 1.0 y 2.0 z 3.0\n" + rows("{x} {y} {z}"));
}

TEST_F(TextNamesTest, ReadsUnits) {
  struct Case {
    std::string head;
    double metres;  // 0: none
  };
  const Case cases[] = {{"x [ft],y [ft],z [ft]\n", 0.3048},
                        {"x(mm),y(mm),z(mm)\n", 1e-3},
                        {"x_cm,y_cm,z_cm\n", 1e-2},
                        {"x,y,z\nmm,mm,mm\n", 1e-3},
                        {"Job,Statue\nUnits,US Survey Feet\nx,y,z\n", 1200.0 / 3937.0},
                        {"# units: mm\n", 1e-3},
                        {"x,y,z\n", 0.0},
                        {"x (easting),y (northing),z (height)\n", 0.0},
                        {"# unit vectors\n", 0.0}};
  for (const Case& c : cases) {
    EXPECT_EQ(read(c.head + rows("{x},{y},{z}")).unit_m.value_or(0.0), c.metres) << c.head;
  }
  EXPECT_EQ(read("X [m] Y [m] Z [m]\n" + rows("{x} {y} {z}")).unit_m, 1.0);
  EXPECT_TRUE(read("x,y,z\nmm,mm,mm\n" + rows("{x},{y},{z}")).warnings.empty());
}

TEST_F(TextNamesTest, NamesUnitsThatItDoesNotKnow) {
  expect_parts(refusal_of("x [mm],y [mm],z [m]\n" + rows("{x},{y},{z}")), "line 1",
               "different units");
  const Scan scan = read("# Units: cubits\n" + rows("{x} {y} {z}"));
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "\"cubits\"", "--unit");
}

TEST_F(TextNamesTest, RefusesAnglesWithRemedy) {
  expect_parts(refusal_of("lon,lat,height\n" + rows("{x},{y},{z}")), "project them to metres");
  expect_parts(refusal_of("range,azimuth,elevation\n" + rows("{x},{y},{z}")),
               "convert ranges and angles");
}

TEST_F(TextNamesTest, ReadsSignsInsideFields) {
  expect_sheet("id,x,y,z\n" + rows("P#{i},{x},{y},{z}"));
  expect_sheet("id,x,y,z\n" + rows("\"a, b\",{x},{y},{z}"));
  expect_sheet(rows("{x} {y} {z} # {i}"));
}

TEST(UnitNames, IgnoreCase) {
  EXPECT_EQ(metres_of_unit("MM"), 1e-3);
  EXPECT_EQ(metres_of_unit("US survey FEET"), 1200.0 / 3937.0);
  EXPECT_EQ(metres_of_unit(""), std::nullopt);
  EXPECT_EQ(metres_of_unit("deg"), std::nullopt);
}

}  // namespace
}  // namespace tactree::builder
