// What a blob says is what went into it.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tactree/core/model/nearest.hpp"
#include "test_models.hpp"

namespace tactree {
namespace {

using core::BlobView;
using core::Profile;
using test::TestBlob;

double quantisation_step(const BlobView& view, std::uint32_t level) {
  return 2.0 * static_cast<double>(view.step_m()) * (1U << (view.depth() - level));
}

class BlobContents : public testing::TestWithParam<Profile> {};
INSTANTIATE_TEST_SUITE_P(Profiles, BlobContents,
                         testing::Values(Profile::kSurface, Profile::kPaper));

// The surface profile moves points along the surface, by up to two sites, to reduce their distance
// from it.
TEST_P(BlobContents, KeepsPositionsWithinReachOfSite) {
  const double reach = GetParam() == Profile::kSurface ? 2.5 : 0.5;
  for (const builder::Model& model : {test::cos_sheet(0.25, 0.0025, GetParam()),
                                      test::random_cloud(20000, 1.0, 0.01, GetParam(), 7)}) {
    const TestBlob blob(model);
    double worst = 0.0;
    for (core::LeafCursor cursor(blob.view()); !cursor.done(); cursor.next()) {
      const core::Leaf& leaf = cursor.leaf();
      for (std::uint32_t p = leaf.first_point; p < leaf.first_point + leaf.point_count; ++p) {
        const core::Vec3 at = blob.view().position(leaf, p);
        const Eigen::Vector3d error = Eigen::Vector3f(at.x, at.y, at.z).cast<double>() -
                                      model.positions[blob.written().source_index[p]];
        worst = std::max(worst,
                         error.cwiseAbs().maxCoeff() / quantisation_step(blob.view(), leaf.level));
      }
    }
    EXPECT_LE(worst, reach + 1e-6);
    EXPECT_GT(worst, 0.9 * reach);  // else the step is not what it claims to be
  }
}

TEST_P(BlobContents, ContainsEveryPointOnce) {
  const builder::Model model = test::cos_sheet(0.1, 0.0025, GetParam());
  const TestBlob blob(model);
  ASSERT_EQ(blob.view().point_count() + blob.written().merged, model.positions.size());
  std::vector<bool> seen(model.positions.size());
  for (const std::uint32_t source : blob.written().source_index) {
    EXPECT_FALSE(seen[source]);
    seen[source] = true;
  }
}

// In the surface profile, the codes of neighbours compensate each other's errors.
TEST_P(BlobContents, KeepsDirectionsOfNormals) {
  const builder::Model model = test::random_cloud(20000, 1.0, 0.01, GetParam(), 3);
  const TestBlob blob(model);
  double smallest = 1.0;
  for (std::uint32_t p = 0; p < blob.view().point_count(); ++p) {
    const core::Vec3 n = blob.view().normal(p);
    EXPECT_NEAR(core::length(n), 1.0, 1e-6);
    smallest =
        std::min(smallest, Eigen::Vector3f(n.x, n.y, n.z)
                               .cast<double>()
                               .dot(model.normals[blob.written().source_index[p]].cast<double>()));
  }
  const double degrees = std::acos(smallest) * 180.0 / M_PI;
  EXPECT_LE(degrees, GetParam() == Profile::kSurface ? 0.7 : 0.34);
  EXPECT_GE(degrees, 0.2);
}

TEST_P(BlobContents, KeepsPositionsOnLattice) {
  const TestBlob blob(test::random_cloud(5000, 3.7, 0.02, GetParam(), 5));
  const double step = static_cast<double>(blob.view().step_m());
  for (const core::Vec3 p : blob.points()) {
    for (const float v : {p.x, p.y, p.z}) {
      const double units = static_cast<double>(v) / step;
      ASSERT_EQ(units, std::round(units));  // double: no rounding that could hide one
    }
  }
}

TEST(Blob, LimitsBytesPerSurfacePoint) {
  for (const builder::Model& model :
       {test::cos_sheet(0.25, 0.0025, Profile::kSurface), test::sphere(0.05, 0.0005)}) {
    const TestBlob blob(model);
    ASSERT_GE(blob.view().point_count(), 30000U);
    EXPECT_LE(static_cast<double>(blob.written().bytes.size()) / blob.view().point_count(), 6.5);
  }
}

TEST(Blob, BalancesDirectorySizeAndDepth) {
  const TestBlob blob(test::cos_sheet(0.25, 0.0025, Profile::kSurface));
  const core::BlobHeader& header = blob.view().header();
  EXPECT_LE(header.directory.bytes, header.points.bytes / 32);
  EXPECT_GT(8 * header.directory.bytes, header.points.bytes / 32);
  EXPECT_LE(header.depth - header.directory_level, 4U);
}

// More points in 32 leaves than 16 bits count: fewer leaves share a base.
TEST(Blob, CountsCrowdedLeaves) {
  builder::Model model;
  for (int i = 0; i < 90000; ++i) {
    model.positions.emplace_back(1e-4 * (i % 300), 1e-4 * (i / 300), 0.0);
    model.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  model.positions.emplace_back(0.05, 0.05, 0.05);
  model.normals.emplace_back(0.0F, 0.0F, 1.0F);
  model.spacing_m = 0.001;
  model.reach_m = 0.003;
  model.support_radius_m = 0.003;
  const TestBlob blob(model);
  const core::BlobHeader& header = blob.view().header();
  EXPECT_LT(header.leaf_group_shift, core::kMaxLeafGroupShift);
  for (std::uint32_t i = 0; i < header.point_count; i += 97) {
    EXPECT_EQ(core::nearest_within(blob.view(), blob.points()[i], 0.003F).index, i);
  }
}

TEST(Blob, SizesSurfaceLeavesForQuery) {
  const TestBlob blob(test::sphere(0.03, 0.001));
  const core::BlobHeader& header = blob.view().header();
  EXPECT_GE(header.leaf_edge_min_m, 2.0F * header.reach_m);
  EXPECT_LE(header.leaf_edge_min_m, 2.1F * header.reach_m);  // larger ones cost time
}

TEST(Blob, LimitsPointsPerPaperLeaf) {
  const TestBlob blob(test::cos_sheet(0.25, 0.0025, Profile::kPaper));
  EXPECT_EQ(blob.view().header().points_per_leaf_max, 10U);
  EXPECT_TRUE(blob.view().has_neighbours());
}

/// Maximum points in a ball of this radius around a point.
std::size_t most_around_point(const TestBlob& blob, float radius) {
  const double r = static_cast<double>(radius);
  std::size_t most = 0;
  for (std::size_t c = 0; c < blob.points().size(); c += 7) {
    std::size_t inside = 0;
    for (const core::Vec3 p : blob.points()) {
      inside += static_cast<double>(core::length_squared(p - blob.points()[c])) <= r * r ? 1U : 0U;
    }
    most = std::max(most, inside);
  }
  return most;
}

TEST(Blob, DeclaresTightBallBound) {
  const TestBlob blob(test::sphere(0.03, 0.001));
  const std::size_t most = most_around_point(blob, blob.view().reach_m());
  EXPECT_GE(blob.view().header().points_per_ball_max, most);
  EXPECT_LE(blob.view().header().points_per_ball_max, most + most / 3);
}

TEST(Blob, DeclaresTightSupportBound) {
  const TestBlob blob(test::sphere(0.03, 0.001));
  const std::size_t most = most_around_point(blob, blob.view().support_radius_m());
  EXPECT_GE(blob.view().header().points_per_support_max, most);
  EXPECT_LE(blob.view().header().points_per_support_max, most + most / 3);
  EXPECT_LT(blob.view().header().points_per_support_max, blob.view().header().points_per_ball_max);
}

TEST(Blob, CountsBallWithoutSupport) {
  core::BlobHeader header{};
  header.points_per_ball_max = 9;
  EXPECT_EQ(core::points_per_support_max(header), 9U);
  header.points_per_support_max = 6;
  EXPECT_EQ(core::points_per_support_max(header), 6U);
}

TEST(Blob, WritesBitIdenticalBytes) {
  const builder::Model model = test::sphere(0.03, 0.001);
  EXPECT_EQ(builder::write_blob(model).bytes, builder::write_blob(model).bytes);
}

TEST(Blob, TruncatesLongNameAtCharacter) {
  builder::Model model = test::sphere(0.01, 0.001);
  model.name = std::string(30, 'a') + "\xC3\xA9t\xC3\xA9";  // the 31st byte is half a character
  EXPECT_EQ(std::string(TestBlob(model).view().header().name), std::string(30, 'a'));
}

TEST(Blob, ReadsBackMaterials) {
  builder::Model model = test::sphere(0.01, 0.001);
  model.materials = {{800.0F, 1.0F, 0.5F, 0.3F, 0.0F, 0.0F, {}},
                     {200.0F, 0.5F, 0.1F, 0.1F, 0.0F, 0.0F, {}}};
  for (const Eigen::Vector3d& p : model.positions) {
    model.material_indices.push_back(p.x() > 0.0 ? 1 : 0);
  }
  const TestBlob blob(model);
  for (std::uint32_t p = 0; p < blob.view().point_count(); ++p) {
    const bool right = model.positions[blob.written().source_index[p]].x() > 0.0;
    EXPECT_EQ(blob.view().material(blob.view().material_of(p)).stiffness_N_m,
              right ? 200.0F : 800.0F);
  }
}

TEST(Blob, RefusesImpossibleModels) {
  builder::Model model = test::sphere(0.01, 0.001);
  builder::Model empty = model;
  empty.positions.clear();
  empty.normals.clear();
  EXPECT_THROW((void)builder::write_blob(empty), std::runtime_error);
  builder::Model huge = model;
  huge.positions.push_back({1e5, 0.0, 0.0});
  huge.normals.push_back({1.0F, 0.0F, 0.0F});
  EXPECT_THROW((void)builder::write_blob(huge), std::runtime_error);
}

TEST(Blob, FindsNothingInEmptyView) {
  const BlobView view;
  EXPECT_TRUE(view.empty());
  EXPECT_EQ(view.point_count(), 0U);
  EXPECT_TRUE(core::LeafCursor(view).done());
}

}  // namespace
}  // namespace tactree
