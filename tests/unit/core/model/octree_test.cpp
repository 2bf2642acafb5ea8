#include "tactree/core/model/octree.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "leaf_set.hpp"
#include "test_models.hpp"

namespace tactree::core {
namespace {

using test::TestBlob;

TEST(Octree, CountsOctants) {
  for (std::uint32_t mask = 0; mask < 256; ++mask) {
    EXPECT_EQ(count_octants(mask), static_cast<std::uint32_t>(std::popcount(mask)));
    if (mask != 0) {
      EXPECT_EQ(lowest_octant(mask), static_cast<std::uint32_t>(std::countr_zero(mask)));
    }
    if (mask < 128) {
      EXPECT_EQ(count_low_octants(mask), count_octants(mask));
    }
  }
}

TEST(Octree, FloorsExactlyToLattice) {
  const TestBlob blob(test::random_cloud(3000, 0.7, 0.01, Profile::kSurface, 11));
  const double step = static_cast<double>(blob.view().step_m());
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-0.35F, 0.35F);
  for (int i = 0; i < 200000; ++i) {
    // Random places, and places at and next to a lattice coordinate.
    float x = place(random);
    if (i % 4 != 0) {
      x = static_cast<float>(std::floor(static_cast<double>(x) / step) * step);
      if (i % 4 == 2) x = std::nextafter(x, 1.0F);
      if (i % 4 == 3) x = std::nextafter(x, -1.0F);
    }
    Int3 site;
    ASSERT_TRUE(to_lattice(blob.view(), {x, 0.0F, 0.0F}, site));
    ASSERT_EQ(site.x, static_cast<std::int32_t>(std::floor(static_cast<double>(x) / step)));
  }
}

TEST(Octree, FindsNothingAtInvalidPositions) {
  const TestBlob blob(test::sphere(0.03, 0.001));
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad : {inf, -inf, nan, 1e30F, -1e30F, 1.0F, -1.0F}) {
    for (const Vec3 p : {Vec3{bad, 0, 0}, Vec3{0, bad, 0}, Vec3{0, 0, bad}}) {
      Int3 site;
      Leaf leaf;
      EXPECT_FALSE(to_lattice(blob.view(), p, site));
      EXPECT_FALSE(find_leaf(blob.view(), p, leaf));
      EXPECT_EQ(test::leaves_within(blob.view(), p, 0.001F).count, 0U);
    }
  }
  for (const float r : {nan, -1.0F, 2.0F * blob.view().reach_m()}) {
    EXPECT_EQ(test::leaves_within(blob.view(), {0.03F, 0.0F, 0.0F}, r).count, 0U);
  }
}

TEST(Octree, FindsLeafOfEveryPoint) {
  for (const Profile profile : {Profile::kSurface, Profile::kPaper}) {
    const TestBlob blob(test::random_cloud(20000, 1.0, 0.01, profile, 2));
    for (LeafCursor cursor(blob.view()); !cursor.done(); cursor.next()) {
      for (std::uint32_t p = 0; p < cursor.leaf().point_count; ++p) {
        Leaf found;
        ASSERT_TRUE(find_leaf(blob.view(), blob.points()[cursor.leaf().first_point + p], found));
        ASSERT_EQ(found.number, cursor.leaf().number);
        ASSERT_EQ(found.level, cursor.leaf().level);
        ASSERT_EQ(found.min, cursor.leaf().min);
      }
    }
  }
}

// All leaves whose cube meets centre +- r, by looking at every leaf.
std::set<std::uint32_t> leaves_by_search(const BlobView& view, Vec3 centre, float r) {
  std::set<std::uint32_t> found;
  const double step = static_cast<double>(view.step_m());
  for (LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const Leaf& leaf = cursor.leaf();
    const double edge = step * (kLeafUnits << (view.depth() - leaf.level));
    bool meets = true;
    const float c[3] = {centre.x, centre.y, centre.z};
    const std::int32_t low[3] = {leaf.min.x, leaf.min.y, leaf.min.z};
    for (int a = 0; a < 3; ++a) {
      const double at = static_cast<double>(c[a]);
      const double reach = static_cast<double>(r);
      meets = meets && at + reach >= step * low[a] && at - reach < step * low[a] + edge;
    }
    if (meets) found.insert(leaf.number);
  }
  return found;
}

TEST(Octree, FindsEveryLeafInCube) {
  const TestBlob blob(test::random_cloud(4000, 1.0, 0.03, Profile::kSurface, 4));
  const BlobView& view = blob.view();
  std::mt19937 random(9);
  std::uniform_real_distribution<float> place(-0.7F, 0.7F);
  std::uniform_int_distribution<int> cell(-8, 8);
  const float edge = view.header().leaf_edge_min_m;
  for (int i = 0; i < 4000; ++i) {
    Vec3 centre{place(random), place(random), place(random)};
    float r = view.reach_m() * (i % 3 == 0 ? 1.0F : 0.3F);
    if (i % 5 == 0) {  // a corner exactly on a cell's face
      const float root = view.step_m() * static_cast<float>(view.header().root_min[0]);
      centre.x = root + edge * static_cast<float>(8 + cell(random)) + r;
    }
    const test::LeafSet set = test::leaves_within(view, centre, r);
    std::set<std::uint32_t> found;
    for (std::uint32_t k = 0; k < set.count; ++k) {
      EXPECT_TRUE(found.insert(set.leaves[k].number).second) << "a leaf twice";
    }
    for (const std::uint32_t number : leaves_by_search(view, centre, r)) {
      ASSERT_TRUE(found.contains(number));
    }
    Leaf own;
    if (find_leaf(view, centre, own)) {
      EXPECT_EQ(set.leaves[0].number, own.number) << "the centre's leaf comes first";
    }
  }
}

}  // namespace
}  // namespace tactree::core
