#include <fmt/format.h>

#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;

class TextTest : public TestFiles {
 protected:
  void expect_123_456(const std::string& text) {
    const Scan scan = read(text);
    ASSERT_EQ(scan.positions.size(), 2U) << text;
    EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1.5, -2, 300)) << text;
    EXPECT_EQ(scan.positions[1], Eigen::Vector3d(4, 5, 6)) << text;
    EXPECT_TRUE(scan.dropped.empty()) << text;
  }
};

TEST_F(TextTest, ReadsDialects) {
  expect_123_456("1.5 -2 300\n4 5 6\n");
  expect_123_456("  1.5\t-2 \t 3e2  \r\n4\t5\t6\r\n");
  expect_123_456("+1.5,-2.,+3E+02\n4,5,6");
  expect_123_456("1.5, -2, 300\n4 , 5 , 6\n");
  expect_123_456("1.5;-2;300\n4;5;6\n");
  expect_123_456("1,5;-2;300,0\n4,0;5;6\n");
  expect_123_456("1,5 -2,0 300,0\n4,0 5,0 6,0\n");
  expect_123_456("# a comment\n\n1.5 -2 300 # here\n// more\n4 5 6 // there\n");
  expect_123_456(
      "\xef\xbb\xbf"
      "1.5 -2 300\n4 5 6\n");
  expect_123_456("2\n1.5 -2 300\n4 5 6\n");
  expect_123_456("1.5,-2,300,\n4,5,6,\n");
  expect_123_456("\"1.5\",\"-2\",\"300\"\n\"4\",\"5\",\"6\"\n");
  expect_123_456("1.5 -2 300 label\n4 5 6 other\n");
}

TEST_F(TextTest, ReadsColumnNames) {
  expect_123_456("X,Y,Z\n1.5,-2,300\n4,5,6\n");
  expect_123_456("x y z\r\n1.5 -2 300\r\n4 5 6\r\n");
  expect_123_456("//X Y Z\n1.5 -2 300\n4 5 6\n");
  expect_123_456("# x;y;z\n1.5;-2;300\n4;5;6\n");
  expect_123_456("name,Z,intensity,y,X\nfirst,300,7,-2,1.5\nsecond,6,,5,4\n");
  expect_123_456("\"x [m]\",\"y [m]\",\"z (m)\"\n1.5,-2,300\n4,5,6\n");
  expect_123_456("//X Y Z R G\n2\n1.5 -2 300 1 2\n4 5 6 1 2\n");
}

TEST_F(TextTest, ReadsNamedNormalsAndColours) {
  const Scan scan =
      read("x,y,z,Nx,Ny,Nz,R,G,B,extra\n1,2,3,0,0,1,255,0,7,9\n4,5,6,1,0,0,1,2,3,9\n");
  EXPECT_EQ(scan.normals.at(1), Eigen::Vector3f(1, 0, 0));
  EXPECT_EQ(scan.colours.at(0), (Colour{255, 0, 7}));
  const Scan unit = read("x y z rf gf bf\n1 2 3 1 0.5 0\n");
  EXPECT_EQ(unit.colours.at(0), (Colour{255, 128, 0}));
}

TEST_F(TextTest, ClassifiesSixColumnsByContent) {
  const Scan normals = read("1 2 3 0 0 1\n4 5 6 0.6 0.8 0\n");
  EXPECT_EQ(normals.normals.at(1), Eigen::Vector3f(0.6F, 0.8F, 0));
  EXPECT_TRUE(normals.colours.empty());
  const Scan colours = read("1 2 3 0 0 1\n4 5 6 60 80 255\n");
  EXPECT_EQ(colours.colours.at(1), (Colour{60, 80, 255}));
  EXPECT_TRUE(colours.normals.empty());
  const Scan neither = read("1 2 3 0.5 700 1\n4 5 6 60 80 255\n");
  EXPECT_TRUE(neither.colours.empty());
  EXPECT_TRUE(neither.normals.empty());
  EXPECT_EQ(neither.warnings.size(), 1U);
}

TEST_F(TextTest, ClassifiesMoreColumnsByContent) {
  const Scan alpha = read("1 2 3 117.0 73.0 49.0 255.0\n4 5 6 1 2 3 255\n");
  EXPECT_EQ(alpha.colours.at(0), (Colour{117, 73, 49}));
  const Scan both = read("1 2 3 117 73 49 0 0 1\n4 5 6 1 2 3 0 1 0\n");
  EXPECT_EQ(both.colours.at(1), (Colour{1, 2, 3}));
  EXPECT_EQ(both.normals.at(1), Eigen::Vector3f(0, 1, 0));
  const Scan pts = read("2\n1 2 3 100 117 73 49\n4 5 6 101 1 2 3\n");
  EXPECT_EQ(pts.colours.at(1), (Colour{1, 2, 3}));
}

TEST_F(TextTest, ComparesLeadingCountWithRows) {
  EXPECT_TRUE(read("2\n1 2 3\n4 5 6\n").warnings.empty());
  const Scan wrong = read("99999999999\n1 2 3\n4 5 6\n");
  EXPECT_EQ(wrong.positions.size(), 2U);
  ASSERT_EQ(wrong.warnings.size(), 1U);
  expect_parts(wrong.warnings[0], "99999999999", "2");
  const Scan two_scans = read("1\n1 2 3\n2\n4 5 6\n7 8 9\n");
  EXPECT_EQ(two_scans.positions.size(), 3U);
  EXPECT_TRUE(two_scans.warnings.empty());
}

TEST_F(TextTest, ReadsNumbersOfAllKinds) {
  const Scan scan = read("nan 1 2\n1.#QNAN 1 2\n1 -inf 2\n1 1 1e400\n1e-400 .5 -.5\n1 -1.#IND 3\n");
  ASSERT_EQ(scan.positions.size(), 1U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(0, 0.5, -0.5));
  EXPECT_EQ(dropped(scan, "non_finite"), 5U);
}

std::string rows(std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += std::to_string(i) + " 2 3\n";
  return text;
}

TEST_F(TextTest, ReadsDecimalCommasAfterWholeRow) {
  for (const char* separator : {";", " ", "\t"}) {
    std::string text = fmt::format("0{0}0{0}0\n", separator);
    for (int i = 1; i < 50; ++i) {
      text += fmt::format("0,{1:03}{0}-0,{2:03}{0}0,{3:03}\n", separator, i, i * i % 900, 3 * i);
    }
    const Scan scan = read(text);
    ASSERT_EQ(scan.positions.size(), 50U);
    EXPECT_EQ(scan.positions[7], Eigen::Vector3d(0.007, -0.049, 0.021));
    expect_parts(scan.notes.at(0), "commas are decimal commas");
  }
}

TEST_F(TextTest, RefusesCommasBetweenThousands) {
  std::string text;
  for (int i = 0; i < 50; ++i) text += fmt::format("{},280\t-963\t16,{}\n", 5 + i, 900 + i);
  expect_parts(refusal_of(text), "line 1", "separate thousands");
}

TEST_F(TextTest, DropsHeightsWithoutData) {
  const auto grid = [](const char* missing) {
    std::string text;
    for (int i = 0; i < 400; ++i) {
      const std::string z = i % 20 < 5 ? missing : fmt::format("{:.2f}", 500.0 + 0.1 * (i % 20));
      text += fmt::format("{} {} {}\n", i % 20, i / 20, z);
    }
    return text;
  };
  for (const char* missing : {"-9999", "-32768.0", "99999"}) {
    const Scan scan = read(grid(missing));
    EXPECT_EQ(scan.positions.size(), 300U);
    EXPECT_EQ(scan.dropped.at("no_data"), 100U);
    ASSERT_EQ(scan.warnings.size(), 1U);
    expect_parts(scan.warnings[0], "100 points with a z of", "missing data");
  }
  EXPECT_EQ(read(grid("999")).positions.size(), 300U);
  EXPECT_EQ(read(grid("-9998")).positions.size(), 400U);  // no such value
  EXPECT_EQ(read(grid("499.5")).positions.size(), 400U);
}

TEST_F(TextTest, CountsFewBadRows) {
  const Scan scan = read(rows(150) + "1 2\n" + rows(49));
  EXPECT_EQ(scan.positions.size(), 199U);
  EXPECT_EQ(dropped(scan, "bad_row"), 1U);
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "line 151");
}

TEST_F(TextTest, RefusesManyBadRows) {
  expect_parts(refusal_of(rows(150) + "1 2\nfoo bar baz\n" + rows(40), "points.xyz"), "points.xyz",
               "line 151", "2 of 192");
}

TEST_F(TextTest, RefusesColumnNamesWithoutXyz) {
  expect_parts(refusal_of("lon,lat,height\n1,2,3\n4,5,6\n"), "line 1", "lon,lat,height");
}

TEST_F(TextTest, RefusesRowsShorterThanNames) {
  expect_parts(refusal_of("a,b,x,y,z\n1,2,3,4\n1,2,3,4\n"), "line 2", "4 values",
               "line 1 names 5 columns");
}

TEST_F(TextTest, RefusesTextWithoutPoints) {
  expect_parts(refusal_of("It was a dark night.\nThe rain fell in torrents, and so on.\n", "a.xyz"),
               "a.xyz", "line 1", "not a list of points", "dark night");
  expect_parts(refusal_of("1 2\n3 4\n"), "line 1", "fewer than three numbers");
  expect_parts(refusal_of("# nothing\n\n// at all\n"), "no point");
  expect_parts(refusal_of("nan nan nan\n"), "none of the 1 positions");
}

TEST_F(TextTest, RefusesVeryLongLine) {
  std::string text = "1 2 3\n4 5 6 ";
  text.append(3 << 20, '7');
  expect_parts(refusal_of(text), "longer than 1 MiB", "line 2");
}

}  // namespace
}  // namespace tactree::builder
