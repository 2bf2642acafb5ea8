// Which surfaces have material behind them, and where that is.

#include "octree/interior.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

constexpr double kBallRadius = 20.0;  // in spacings

struct Surface {
  Cloud cloud;

  /// Points of a sphere where `keep` is true.
  void add_sphere(double radius, double side = 1.0,
                  const std::function<bool(const Eigen::Vector3d&)>& keep = nullptr) {
    const auto count = static_cast<std::size_t>(4.0 * std::numbers::pi * radius * radius);
    const Cloud sphere = even_sphere(count, radius);
    for (std::size_t i = 0; i < sphere.size(); ++i) {
      if (keep == nullptr || keep(sphere.positions[i] / radius)) {
        cloud.positions.push_back(sphere.positions[i]);
        cloud.normals.push_back(static_cast<float>(side) * sphere.normals[i]);
      }
    }
  }
  void add_sheet(double height, double up, int half = 20) {
    for (int i = -half; i <= half; ++i) {
      for (int j = -half; j <= half; ++j) {
        cloud.positions.emplace_back(i, j, height);
        cloud.normals.emplace_back(0.0F, 0.0F, static_cast<float>(up));
      }
    }
  }
  [[nodiscard]] Interior interior(std::span<const std::uint8_t> doubtful = {}) const {
    return Interior({cloud.positions, cloud.normals, doubtful, 1.0});
  }
};

TEST(Interior, FillsBody) {
  Surface ball;
  ball.add_sphere(kBallRadius);
  const Interior interior = ball.interior();
  EXPECT_EQ(interior.backed_share(), 1.0);
  EXPECT_TRUE(interior.is_material({0.0, 0.0, 0.0}));
  EXPECT_TRUE(interior.is_material({0.0, kBallRadius - 2.0, 0.0}));
  EXPECT_FALSE(interior.is_material({0.0, kBallRadius + 2.0, 0.0}));
  EXPECT_FALSE(interior.is_material({0.0, 0.0, 5.0 * kBallRadius}));
}

// As a statue that was not scanned from below.
TEST(Interior, FillsBodyOpenBelow) {
  Surface statue;
  statue.add_sphere(kBallRadius, 1.0, [](const Eigen::Vector3d& d) { return d.z() > -0.7; });
  EXPECT_EQ(statue.interior().backed_share(), 1.0);
  EXPECT_TRUE(statue.interior().is_material({0.0, 0.0, 0.0}));
}

TEST(Interior, LeavesSheetAndBowlEmpty) {
  Surface sheet;
  sheet.add_sheet(0.0, 1.0);
  EXPECT_EQ(sheet.interior().backed_share(), 0.0);
  EXPECT_FALSE(sheet.interior().is_material({0.0, 0.0, -3.0}));
  Surface bowl;
  bowl.add_sphere(kBallRadius, 1.0, [](const Eigen::Vector3d& d) { return d.z() > 0.2; });
  EXPECT_EQ(bowl.interior().backed_share(), 0.0);
}

TEST(Interior, FillsThinPlate) {
  for (const double thickness : {0.3, 0.5, 1.0}) {
    Surface plate;
    plate.add_sheet(0.5 * thickness, 1.0);
    plate.add_sheet(-0.5 * thickness, -1.0);
    EXPECT_EQ(plate.interior().backed_share(), 1.0) << thickness;
  }
}

TEST(Interior, FillsRoomWall) {
  Surface room;
  room.add_sphere(kBallRadius, -1.0);
  EXPECT_EQ(room.interior().backed_share(), 1.0);
  EXPECT_FALSE(room.interior().is_material({0.0, 0.0, 0.0}));
  EXPECT_TRUE(room.interior().is_material({0.0, 0.0, kBallRadius + 2.0}));
  room.add_sphere(0.4 * kBallRadius);  // something that stands in it
  EXPECT_EQ(room.interior().backed_share(), 1.0);
  EXPECT_TRUE(room.interior().is_material({0.0, 0.0, 0.0}));
  EXPECT_FALSE(room.interior().is_material({0.0, 0.0, 0.7 * kBallRadius}));
}

TEST(Interior, FillsShellOfHollowBody) {
  Surface shell;
  shell.add_sphere(kBallRadius);
  shell.add_sphere(0.5 * kBallRadius, -1.0);
  EXPECT_EQ(shell.interior().backed_share(), 1.0);
  EXPECT_FALSE(shell.interior().is_material({0.0, 0.0, 0.0}));
  EXPECT_TRUE(shell.interior().is_material({0.0, 0.0, 0.75 * kBallRadius}));
}

TEST(Interior, TellsSheetFromAdjacentBody) {
  Surface both;
  both.add_sphere(kBallRadius);
  const std::size_t of_ball = both.cloud.size();
  both.add_sheet(kBallRadius + 8.0, 1.0);
  const Interior interior = both.interior();
  for (std::uint32_t i = 0; i < both.cloud.size(); ++i) {
    ASSERT_EQ(interior.is_backed(i), i < of_ball) << i;
  }
}

TEST(Interior, LeavesDoubtfulPieceEmpty) {
  Surface ball;
  ball.add_sphere(kBallRadius);
  std::vector<std::uint8_t> doubtful(ball.cloud.size(), 1);
  EXPECT_EQ(ball.interior(doubtful).backed_share(), 0.0);
  std::fill_n(doubtful.begin(), 9 * doubtful.size() / 10, std::uint8_t{0});
  EXPECT_EQ(ball.interior(doubtful).backed_share(), 1.0);
}

}  // namespace
}  // namespace tactree::builder
