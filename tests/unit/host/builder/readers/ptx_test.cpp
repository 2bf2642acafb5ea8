
#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Eigen::Vector3d;

class PtxTest : public TestFiles {};

// A turn by 90 degrees about z, and a shift.
constexpr const char* kTurned = "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";
constexpr const char* kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

std::string header(int columns, int rows, const std::string& matrix) {
  return std::to_string(columns) + "\n" + std::to_string(rows) + "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n" +
         matrix;
}

/// A wall 2 in front of the scanner, column by column; `mirrored`: from right to left.
std::string wall(int columns, int rows, bool mirrored = false, const std::string& rest = " 0.5") {
  std::string text;
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) {
      const int y = mirrored ? c - columns : columns - c;
      text += "2 " + std::to_string(y) + " " + std::to_string(rows - r) + rest + "\n";
    }
  }
  return text;
}

TEST_F(PtxTest, TransformsPointsAndScanner) {
  for (const bool mirrored : {false, true}) {
    const Scan scan = read(header(4, 3, kTurned) + wall(4, 3, mirrored));
    EXPECT_EQ(scan.format, "PTX");
    ASSERT_EQ(scan.positions.size(), 12U);
    EXPECT_EQ(scan.positions[0], Vector3d(mirrored ? 14 : 6, 22, 33));
    ASSERT_EQ(scan.poses.size(), 1U);
    EXPECT_EQ(scan.poses[0].position, Vector3d(10, 20, 30));
    EXPECT_TRUE(scan.poses[0].sure);
    EXPECT_TRUE(scan.warnings.empty());
  }
}

TEST_F(PtxTest, EachScanHasItsScanner) {
  const Scan scan = read(header(4, 3, kIdentity) + wall(4, 3) + "\n" + header(2, 5, kTurned) +
                         wall(2, 5) + "\n\n");
  ASSERT_EQ(scan.positions.size(), 22U);
  ASSERT_EQ(scan.poses.size(), 2U);
  EXPECT_EQ(scan.poses[0].position, Vector3d(0, 0, 0));
  EXPECT_EQ(scan.poses[0].first_point, 0U);
  EXPECT_EQ(scan.poses[1].position, Vector3d(10, 20, 30));
  EXPECT_EQ(scan.poses[1].first_point, 12U);
}

TEST_F(PtxTest, OmitsUnmeasuredPoints) {
  std::string points = wall(4, 3);
  points.replace(0, points.find('\n'), "0 0 0 0.5");
  const Scan scan = read(header(4, 3, kTurned) + points);
  EXPECT_EQ(scan.positions.size(), 11U);
  EXPECT_EQ(scan.dropped.at("not_measured"), 1U);
  EXPECT_EQ(scan.poses.size(), 1U);
}

TEST_F(PtxTest, ReadsColours) {
  const Scan scan = read(header(4, 3, kIdentity) + wall(4, 3, false, " 0.5 255 128 0"));
  ASSERT_EQ(scan.colours.size(), 12U);
  EXPECT_EQ(scan.colours[5], (std::array<std::uint8_t, 3>{255, 128, 0}));
  EXPECT_TRUE(read(header(4, 3, kIdentity) + wall(4, 3)).colours.empty());
}

TEST_F(PtxTest, IgnoresColoursOfAPart) {
  const std::string plain = header(4, 3, kIdentity) + wall(4, 3);
  const std::string coloured = header(4, 3, kIdentity) + wall(4, 3, false, " 0.5 255 128 0");
  for (const std::string& text : {plain + coloured, coloured + plain}) {
    const Scan scan = read(text);
    EXPECT_EQ(scan.positions.size(), 24U);
    EXPECT_TRUE(scan.colours.empty());
    ASSERT_EQ(scan.warnings.size(), 1U);
    expect_parts(scan.warnings[0], "Only 12 of 24 points have colours");
  }
  std::string cut = coloured;
  cut.replace(cut.rfind(" 128 0"), 6, "");
  expect_parts(refusal_of(cut), "line 22", "fewer than 7");
}

TEST_F(PtxTest, UnmeasuredPointsNeedNoColour) {
  for (const std::string line : {"0 0 0 0.5", "0 0 0 0.5 0 0 0"}) {
    for (const int row : {0, 5}) {
      std::string points = wall(4, 3, false, " 0.5 255 128 0");
      std::size_t at = 0;
      for (int i = 0; i < row; ++i) at = points.find('\n', at) + 1;
      points.replace(at, points.find('\n', at) - at, line);
      const Scan scan = read(header(4, 3, kIdentity) + points);
      ASSERT_EQ(scan.colours.size(), 11U);
      EXPECT_EQ(scan.colours[5], (std::array<std::uint8_t, 3>{255, 128, 0}));
      EXPECT_TRUE(scan.warnings.empty());
    }
  }
}

// Programs write points in the frame of the file beside a scanner at its origin.
TEST_F(PtxTest, IgnoresContradictedScanner) {
  std::string saw;  // seen from the origin, its teeth turn this side and that
  for (int c = 0; c < 6; ++c) {
    for (int r = 0; r < 4; ++r) {
      saw += std::to_string(c % 2 == 0 ? 5 : 9) + " " + std::to_string(c % 2 == 0 ? c : -9 * c) +
             " " + std::to_string(r + 1) + " 0.5\n";
    }
  }
  const Scan scan = read(header(6, 4, kIdentity) + saw);
  EXPECT_EQ(scan.positions.size(), 24U);
  EXPECT_TRUE(scan.poses.empty());
  ASSERT_EQ(scan.warnings.size(), 1U);
  expect_parts(scan.warnings[0], "1 of 1 scans", "--viewpoint");
}

TEST_F(PtxTest, ChecksDeclaredCounts) {
  const std::string rest = std::string("\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n") + kIdentity + wall(1, 1);
  expect_parts(refusal_of("4294967296\n4294967296" + rest, "a.ptx"), "a.ptx", "line 2",
               "4294967296 x 4294967296 points", "room for");
  expect_parts(refusal_of("1000000\n1" + rest), "1000000 x 1 points", "room for");
  expect_parts(refusal_of("0\n1" + rest), "line 1", "\"0\"");
  expect_parts(refusal_of("3\n-1" + rest), "line 2", "\"-1\"");
  expect_parts(refusal_of("2.5\n1" + rest), "line 1", "\"2.5\"");
}

TEST_F(PtxTest, NamesLineOfDamage) {
  const std::string head = header(2, 2, kIdentity);
  expect_parts(refusal_of(head + "1 2 3 4\n1 2 3 4\n1 2 3 4\n"), "line 13", "4 points", "only 3");
  expect_parts(refusal_of(head + "1 2 3 4\n1 2 x 4\n1 2 3 4\n1 2 3 4\n"), "line 12", "\"x\"");
  expect_parts(refusal_of(head + "1 2 3 4\n1 2 3\n1 2 3 4\n1 2 3 4\n"), "line 12", "fewer than 4");
  expect_parts(refusal_of(head + wall(2, 2) + "5\n"), "line 15", "header of scan 2");
  expect_parts(refusal_of(head + wall(2, 2) + "5\n6\n"), "line 16", "scan 2", "room for 0");
  expect_parts(refusal_of(head + wall(2, 2) + "five\n6\n"), "line 15", "\"five\"", "scan 2");
  for (const std::string bad :
       {"1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n", "1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n",
        "0 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", "nan 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"}) {
    expect_parts(refusal_of(header(2, 2, bad) + wall(2, 2)), "line 10", "matrix");
  }
}

TEST_F(PtxTest, RefusesTruncationAfterHeader) {
  const std::string whole = header(3, 3, kTurned) + wall(3, 3);
  EXPECT_EQ(read(whole).positions.size(), 9U);
  // A last number that lost digits cannot be told from a shorter one.
  for (std::size_t length = header(3, 3, kTurned).size(); length + 5 < whole.size(); ++length) {
    expect_parts(refusal_of(std::string_view(whole).substr(0, length), "cut.ptx"), "cut.ptx");
  }
}

}  // namespace
}  // namespace tactree::builder
