#include "test_files.hpp"

namespace tactree::builder {
namespace {

using Colour = std::array<std::uint8_t, 3>;
using Triangle = std::array<std::uint32_t, 3>;

class OffTest : public TestFiles {};

TEST_F(OffTest, ReadsPlainFile) {
  const Scan scan = read(
      "OFF # a square\n# comment\n\n4 1 0\n0 0 0\n1 0 0 # here\n\n1 1 5648349.895035\n0 1 0\n"
      "4 0 1 2 3 255 0 0\n");
  EXPECT_EQ(scan.format, "OFF");
  EXPECT_EQ(scan.positions.at(2).z(), 5648349.895035);
  ASSERT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.triangles[1], (Triangle{0, 2, 3}));
  EXPECT_TRUE(scan.colours.empty());
}

TEST_F(OffTest, ReadsCountsBesideKeyword) {
  const Scan scan = read("OFF 2 0\n1 2 3\n4 5 6");
  EXPECT_EQ(scan.positions.size(), 2U);
  EXPECT_FALSE(scan.is_mesh());
}

TEST_F(OffTest, ReadsCountsGluedToKeyword) {
  const Scan scan = read("OFF4 1 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n");
  EXPECT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.triangles.size(), 1U);
}

TEST_F(OffTest, ReadsColoursAndNormals) {
  const Scan coff =
      read("COFF\n3 1 0\n0 0 0 255 128 0 255\n1 0 0 1 2 3 255\n0 1 0 0 0 0 255\n3 0 1 2\n");
  EXPECT_EQ(coff.colours.at(0), (Colour{255, 128, 0}));
  EXPECT_EQ(coff.colours.at(1), (Colour{1, 2, 3}));
  const Scan unnamed = read("OFF\n3 1\n0 0 0 1.0 0.5 0\n1 0 0 0 0 1\n0 1 0 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(unnamed.colours.at(0), (Colour{255, 128, 0}));
  const Scan noff = read("NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 1 0\n3 0 1 2\n");
  EXPECT_EQ(noff.normals.at(2), Eigen::Vector3f(0, 1, 0));
  EXPECT_TRUE(noff.colours.empty());
}

TEST_F(OffTest, ChecksDeclaredCounts) {
  expect_parts(refusal_of("OFF\n353535235358 6 0\n0 0 0\n", "m.off"), "m.off", "line 2",
               "353535235358 points", "room");
  expect_parts(refusal_of("OFF\n1 99999999999 0\n0 0 0\n"), "line 2", "99999999999 faces");
  expect_parts(refusal_of("OFF\n-1 6 0\n0 0 0\n"), "line 2", "\"-1\"");
  expect_parts(refusal_of("OFF\n0 0 0\n"), "contains no points");
  expect_parts(refusal_of("OFF\n"), "before its counts");
}

TEST_F(OffTest, NamesLineOfDamage) {
  expect_parts(refusal_of("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), "line 4", "fewer than 3");
  expect_parts(refusal_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), "line 6", "vertex 3 of 3");
  expect_parts(refusal_of("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "1 of 2 faces");
  expect_parts(refusal_of("OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0 #####\n"), "3 of 4 points");
  expect_parts(refusal_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "none of the 1 faces",
               "line 6");
}

/// The numbers of a binary OFF, each a float or an std::int32_t.
template <typename... Numbers>
std::string big_endian(Numbers... numbers) {
  return (bytes_of(numbers, true) + ...);
}

TEST_F(OffTest, ReadsBinaryFile) {
  const Scan scan = read("OFF BINARY\n" + big_endian(4, 1, 0) + big_endian(0.0F, 0.0F, 0.5F) +
                         big_endian(1.0F, 0.0F, 0.5F) + big_endian(1.0F, 1.0F, 0.5F) +
                         big_endian(0.0F, 1.0F, 0.5F) + big_endian(4, 0, 1, 2, 3) +
                         big_endian(3, 0.5F, 0.5F, 0.5F));
  EXPECT_EQ(scan.format, "OFF binary");
  ASSERT_EQ(scan.positions.size(), 4U);
  EXPECT_EQ(scan.positions[2], Eigen::Vector3d(1, 1, 0.5));
  ASSERT_EQ(scan.triangles.size(), 2U);
  EXPECT_EQ(scan.triangles[1], (Triangle{0, 2, 3}));
}

TEST_F(OffTest, ReadsBinaryNormalsAndColours) {
  const Scan scan = read("STCNOFF BINARY\n" + big_endian(1, 0, 0) + big_endian(1.0F, 2.0F, 3.0F) +
                         big_endian(0.0F, 0.0F, 1.0F) + big_endian(1.0F, 0.5F, 0.0F, 1.0F) +
                         big_endian(7.0F, 7.0F));
  ASSERT_EQ(scan.positions.size(), 1U);
  EXPECT_EQ(scan.positions[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(scan.normals.at(0), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(scan.colours.at(0), (Colour{255, 128, 0}));
}

TEST_F(OffTest, ChecksBinaryCounts) {
  const std::string points = big_endian(0.0F, 0.0F, 0.0F);
  const auto refused = [&](const std::string& rest) {
    return refusal_of("OFF BINARY\n" + rest, "m.off");
  };
  expect_parts(refused(big_endian(2147483647, 0, 0) + points), "2147483647 points", "room for 1");
  expect_parts(refused(big_endian(-1, 0, 0) + points), "-1", "number of points");
  expect_parts(refused(big_endian(0, 0, 0)), "no point");
  expect_parts(refused(big_endian(1, 5, 0) + points), "5 faces", "room for 0");
  expect_parts(refused(big_endian(1, 1, 0) + points + big_endian(2147483647, 0)),
               "2147483647 vertices");
  expect_parts(refused(big_endian(1, 1, 0) + points + big_endian(1, 0)), "too early");
  expect_parts(refused(big_endian(1, 1, 0) + points + big_endian(0, 9)), "too early");
  expect_parts(refused(big_endian(1, 0)), "too early");
}

}  // namespace
}  // namespace tactree::builder
