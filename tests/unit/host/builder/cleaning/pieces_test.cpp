#include "cleaning/pieces.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kLarge = 6000;
constexpr std::size_t kSmall = 1000;

// Two spheres, the smaller one 30 mm beside the larger.
Scan two_spheres() {
  Scan scan;
  scan.positions = random_sphere(kLarge, 0.02).positions;
  for (const Eigen::Vector3d& p : random_sphere(kSmall, 0.008).positions) {
    scan.positions.emplace_back(p + Eigen::Vector3d(0.05, 0.0, 0.0));
  }
  return scan;
}

// Two boxes whose faces do not share their corners, as in STL.
Scan two_boxes() {
  Scan scan;
  for (const double x : {0.0, 0.1}) {
    const Mesh box = box_mesh({x, 0.0, 0.0}, {x + 0.03 + 0.1 * x, 0.03, 0.03});
    for (const auto& triangle : box.triangles) {
      const auto first = static_cast<std::uint32_t>(scan.positions.size());
      for (const std::uint32_t corner : triangle) {
        scan.positions.push_back(box.positions[corner]);
      }
      scan.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return scan;
}

BuildResult built(const Scan& scan, bool largest, std::uint64_t least) {
  Progress quiet;
  BuildOptions options;
  options.name = "pieces";
  options.keep_largest = largest;
  options.min_piece = least;
  return build_model({scan}, options, quiet);
}

std::uint64_t dropped(const BuildResult& result, const std::string& cause) {
  const auto found = result.report.dropped.find(cause);
  return found == result.report.dropped.end() ? 0 : found->second;
}

TEST(Pieces, AreAllKeptByDefault) {
  EXPECT_EQ(dropped(built(two_spheres(), false, 0), "small_piece"), 0U);
}

TEST(Pieces, KeepsLargestOfCloud) {
  const BuildResult result = built(two_spheres(), true, 0);
  EXPECT_EQ(dropped(result, "small_piece"), kSmall);
  EXPECT_LT(result.report.bounds.max().x(), 0.021);
  EXPECT_EQ(result.report.input_points, result.report.kept_points + kSmall);
}

TEST(Pieces, DropsCloudPiecesBelowLimit) {
  EXPECT_EQ(dropped(built(two_spheres(), false, kSmall), "small_piece"), 0U);
  EXPECT_EQ(dropped(built(two_spheres(), false, kSmall + 1), "small_piece"), kSmall);
  EXPECT_THROW((void)built(two_spheres(), false, kLarge + 1), BuildError);
}

TEST(Pieces, JoinsMeshPiecesByCorners) {
  const BuildResult all = built(two_boxes(), false, 8);
  EXPECT_EQ(dropped(all, "small_piece_face"), 0U);
  const BuildResult result = built(two_boxes(), true, 0);
  EXPECT_EQ(dropped(result, "small_piece_face"), 12U);
  EXPECT_NEAR(result.report.bounds.sizes().x(), 0.03, 1e-6);
  EXPECT_EQ(result.report.input_points, result.report.kept_points + dropped(result, "small_piece") +
                                            dropped(result, "not_in_a_face"));
}

}  // namespace
}  // namespace tactree::builder
