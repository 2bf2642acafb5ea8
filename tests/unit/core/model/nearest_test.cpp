#include "tactree/core/model/nearest.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "tactree/core/model/octree.hpp"
#include "test_models.hpp"

namespace tactree::core {
namespace {

using test::TestBlob;

double distance_squared(Vec3 a, Vec3 b) {
  const double x = static_cast<double>(a.x) - static_cast<double>(b.x);
  const double y = static_cast<double>(a.y) - static_cast<double>(b.y);
  const double z = static_cast<double>(a.z) - static_cast<double>(b.z);
  return x * x + y * y + z * z;
}

struct Case {
  const char* name;
  builder::Model model;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"sheet", test::cos_sheet(0.25, 0.0025, Profile::kSurface)});
  all.push_back({"sphere", test::sphere(0.03, 0.001)});
  all.push_back({"cloud", test::random_cloud(20000, 1.0, 0.02, Profile::kSurface, 21)});
  all.push_back({"leaves of many sizes", test::random_cloud(3000, 1.0, 0.02, Profile::kPaper, 22)});
  return all;
}

// Probes near points, at points, on cell faces and anywhere about the root cube.
class Probes {
 public:
  Probes(const TestBlob& blob, std::uint32_t seed) : blob_(blob), random_(seed) {}

  Vec3 next() {
    const BlobHeader& header = blob_.view().header();
    const Vec3 near = blob_.points()[pick_(random_) % blob_.points().size()];
    const float reach = 2.0F * header.reach_m;
    switch (pick_(random_) % 4U) {
      case 0:
        return near;
      case 1: {  // on a face between cells
        const float edge = header.leaf_edge_min_m;
        return {edge * std::round(near.x / edge), near.y + offset(reach), near.z + offset(reach)};
      }
      case 2:
        return {offset(1.2F * header.bounds_max_m[0]), offset(1.2F * header.bounds_max_m[1]),
                offset(1.2F * header.bounds_max_m[2])};
      default:
        return {near.x + offset(reach), near.y + offset(reach), near.z + offset(reach)};
    }
  }

 private:
  float offset(float scale) { return scale * unit_(random_); }

  const TestBlob& blob_;
  std::mt19937 random_;
  std::uniform_real_distribution<float> unit_{-1.0F, 1.0F};
  std::uniform_int_distribution<std::uint32_t> pick_;
};

TEST(Nearest, AgreesWithBruteForce) {
  for (const Case& c : cases()) {
    const TestBlob blob(c.model);
    Probes probes(blob, 5);
    std::size_t found = 0;
    for (int i = 0; i < 1500; ++i) {
      const Vec3 probe = probes.next();
      const float r = blob.view().reach_m() * (i % 2 == 0 ? 1.0F : 0.4F);
      const NearestPoint answer = nearest_within(blob.view(), probe, r);
      double best = 1e30;
      for (const Vec3 p : blob.points()) best = std::min(best, distance_squared(p, probe));
      const double limit = static_cast<double>(r) * static_cast<double>(r);
      if (std::abs(best - limit) < 1e-6 * limit) continue;  // below the resolution of float32
      ASSERT_EQ(answer.found(), best <= limit) << c.name;
      if (!answer.found()) continue;
      ++found;
      ASSERT_NEAR(std::sqrt(distance_squared(blob.points()[answer.index], probe)), std::sqrt(best),
                  1e-6 * static_cast<double>(r))
          << c.name;
      ASSERT_EQ(answer.position, blob.points()[answer.index]);
    }
    EXPECT_GT(found, 200U) << c.name;
  }
}

// A lattice of points: a probe in the middle between some is as far from all of them, exactly, even
// where they are in different leaves.
TEST(Nearest, PrefersLowestIndexOnTie) {
  builder::Model model;
  constexpr double kSpacing = 0.015625;
  for (int i = 0; i < 20 * 20 * 20; ++i) {
    model.positions.emplace_back(kSpacing * (i % 20 + 8), kSpacing * (i / 20 % 20 + 8),
                                 kSpacing * (i / 400 + 8));
    model.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  model.spacing_m = kSpacing;
  model.reach_m = 1020.0 / 32768.0;  // makes the lattice's step 2^-15: equal gaps between points
  model.support_radius_m = model.reach_m;
  const TestBlob blob(model);
  ASSERT_EQ(blob.view().step_m(), 1.0F / 32768.0F);
  std::mt19937 random(3);
  std::uniform_int_distribution<std::uint32_t> pick(0, 8000 - 421 - 1);
  std::size_t across_leaves = 0;
  for (int i = 0; i < 2000; ++i) {
    // Between a point and one beside, behind or above it, or any corner of such a cube.
    const Vec3 a = blob.points()[pick(random)];
    const float half = 0.5F * static_cast<float>(kSpacing);
    const Vec3 probe{a.x + (i % 2 == 0 ? half : 0.0F), a.y + (i % 4 < 2 ? half : 0.0F),
                     a.z + (i % 8 < 4 ? half : 0.0F)};
    double best = 1e30;
    for (const Vec3 p : blob.points()) best = std::min(best, distance_squared(p, probe));
    std::uint32_t lowest = kNoPoint;
    std::set<std::uint32_t> leaves;
    for (std::uint32_t p = 0; p < blob.points().size(); ++p) {
      if (distance_squared(blob.points()[p], probe) == best) {
        lowest = std::min(lowest, p);
        Leaf leaf;
        ASSERT_TRUE(find_leaf(blob.view(), blob.points()[p], leaf));
        leaves.insert(leaf.number);
      }
    }
    across_leaves += leaves.size() > 1 ? 1U : 0U;
    ASSERT_EQ(nearest_within(blob.view(), probe, blob.view().reach_m()).index, lowest);
  }
  EXPECT_GT(across_leaves, 100U);
}

TEST(Nearest, MatchesBruteForceVertexBoxes) {
  for (const Case& c : cases()) {
    const TestBlob blob(c.model);
    Probes probes(blob, 7);
    const double half = 0.5 * static_cast<double>(blob.view().header().aabb_edge_m);
    std::size_t contacts = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 probe = probes.next();
      bool inside = false;
      bool too_close = false;
      for (const Vec3 p : blob.points()) {
        const double d =
            std::max({std::abs(static_cast<double>(p.x) - static_cast<double>(probe.x)),
                      std::abs(static_cast<double>(p.y) - static_cast<double>(probe.y)),
                      std::abs(static_cast<double>(p.z) - static_cast<double>(probe.z))});
        inside = inside || d <= half;
        too_close = too_close || std::abs(d - half) < 1e-6 * half;
      }
      if (too_close) continue;
      ASSERT_EQ(in_any_vertex_box(blob.view(), probe), inside) << c.name;
      contacts += inside ? 1U : 0U;
    }
    EXPECT_GT(contacts, 100U) << c.name;
  }
}

TEST(Nearest, FindsNothingInEmptyModel) {
  EXPECT_FALSE(nearest_within({}, {}, 1.0F).found());
  EXPECT_FALSE(in_any_vertex_box({}, {}));
}

}  // namespace
}  // namespace tactree::core
