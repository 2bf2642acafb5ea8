#include "scan_builder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace tactree::builder {
namespace {

ReadOptions limit(std::uint64_t bytes, std::uint64_t most_points = 0) {
  ReadOptions options;
  options.scan_memory_bytes = bytes;
  options.most_points = most_points;
  return options;
}

TEST(ScanBuilder, FacesRespectMemoryLimit) {
  ScanBuilder builder("scan", limit(100'000), "line");
  builder.reserve_points(3'800);  // of 24 bytes; 733 triangles of 12 bytes fit beside
  const std::array<std::int64_t, 3> corners = {0, 1, 2};
  for (int i = 0; i < 733; ++i) builder.add_face(corners, 1);
  EXPECT_THROW(builder.add_face(corners, 1), ReadError);
}

TEST(ScanBuilder, PolygonsRespectMemoryLimit) {
  ScanBuilder builder("scan", limit(100'000), "line");
  builder.reserve_points(3'800);  // 2200 numbers of 4 bytes fit beside, five for each square
  const std::array<std::int64_t, 4> corners = {0, 1, 2, 3};
  for (int i = 0; i < 440; ++i) builder.add_face(corners, 1);
  EXPECT_THROW(builder.add_face(corners, 1), ReadError);
}

TEST(ScanBuilder, DroppedPointsRespectMemoryLimit) {
  ScanBuilder builder("scan", limit(8'000), "line");
  PointRow row{};
  row[kX] = std::numeric_limits<double>::infinity();
  const auto add_many = [&] {
    for (int i = 0; i < 3'000; ++i) builder.add_point(row);
  };
  EXPECT_THROW(add_many(), ReadError);
}

TEST(ScanBuilder, PointsRespectMemoryLimit) {
  ScanBuilder builder("scan", limit(100 * 24), "line");
  const PointRow row{};
  for (int i = 0; i < 62; ++i) builder.add_point(row);
  const auto add_many = [&] {
    for (int i = 0; i < 39; ++i) builder.add_point(row);
  };
  EXPECT_THROW(add_many(), ReadError);
}

TEST(ScanBuilder, AcceptsExcessiveEstimates) {
  ScanBuilder builder("scan", limit(2'400), "line");
  builder.expect_points(1'000'000'000'000);
  builder.add_point({});
  EXPECT_EQ(builder.finish("test").positions.size(), 1U);
  EXPECT_THROW(ScanBuilder("scan", limit(2'400), "line").reserve_points(101), ReadError);
}

TEST(ScanBuilder, FindsSlotsByName) {
  EXPECT_EQ(slot_of_name("X"), kX);
  EXPECT_EQ(slot_of_name("normal_z"), kNz);
  EXPECT_EQ(slot_of_name("Diffuse_Green"), kGreen);
  EXPECT_EQ(slot_of_name("xx"), kNoSlot);
  EXPECT_EQ(slot_of_name(""), kNoSlot);
}

}  // namespace
}  // namespace tactree::builder
