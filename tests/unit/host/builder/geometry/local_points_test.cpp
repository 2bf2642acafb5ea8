#include "geometry/local_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/disjoint_sets.hpp"
#include "shapes.hpp"

namespace tactree::builder {
namespace {

std::vector<std::uint32_t> sorted_indices(const std::vector<Neighbour>& found) {
  std::vector<std::uint32_t> indices;
  for (const Neighbour& n : found) {
    indices.push_back(n.index);
  }
  std::sort(indices.begin(), indices.end());
  return indices;
}

TEST(LocalPoints, AgreeWithCloud) {
  const ZOrderedCloud points(random_sphere(3000, 1.0));
  const std::vector<std::uint32_t> some = [] {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < 3000; i += 7) {
      indices.push_back(i);
    }
    return indices;
  }();
  const ZOrderedCloud centres = points.subset(some);
  std::vector<std::uint8_t> visited(centres.size(), 0);
  std::vector<std::uint8_t> equal(centres.size(), 0);
  for (const double radius : {0.03, 0.2, 3.0}) {
    for_each_with_local(centres, points, radius, [&](LocalPoints& local, std::uint32_t i) {
      ++visited[i];
      const Eigen::Vector3d& p = centres.positions()[i];
      std::vector<Neighbour> own;
      std::vector<Neighbour> other;
      local.visit_within(p, 0.9 * radius, [&](std::uint32_t k, double squared) {
        own.push_back({squared, k});
      });
      points.visit_within(p, 0.9 * radius, [&](std::uint32_t k, double squared) {
        other.push_back({squared, k});
      });
      const bool same = sorted_indices(own) == sorted_indices(other);
      // With the smallest radius, most points have fewer neighbours than these.
      local.find_nearest_unsorted(p, 12, own);
      points.find_nearest(p, 12, radius, other);
      equal[i] = same && sorted_indices(own) == sorted_indices(other) ? 1 : 0;
    });
    EXPECT_EQ(std::count(equal.begin(), equal.end(), 1), static_cast<int>(centres.size()));
  }
  EXPECT_EQ(std::count(visited.begin(), visited.end(), 3), static_cast<int>(centres.size()));
}

TEST(KeepNearest, PrefersLowIndicesAtEqualDistances) {
  std::vector<Neighbour> found = {{2.0, 9}, {1.0, 8}, {2.0, 3}, {0.5, 7}, {2.0, 1}};
  keep_nearest(3, found);
  EXPECT_EQ(sorted_indices(found), (std::vector<std::uint32_t>{1, 7, 8}));
  keep_nearest(5, found);
  EXPECT_EQ(found.size(), 3U);
  keep_nearest(0, found);
  EXPECT_TRUE(found.empty());
}

TEST(KeepNearest, IsExactForAnyDistances) {
  const auto squared = [](int kind, std::uint32_t i) {
    const double part = static_cast<double>(hash64(i) % 1000) / 1000.0;
    switch (kind) {
      case 0:
        return part;  // as on a surface
      case 1:
        return 0.0;  // copies of one point
      case 2:
        return std::floor(3.0 * part);  // many at the same distances
      case 3:
        return std::exp(50.0 * part);  // most near, one far away
      case 4:
        return 1.0 - std::exp(-30.0 * part);  // most far away
      default:
        return i == 5 ? 1e300 : 1e-300 * part;  // beyond any interpolation
    }
  };
  for (int kind = 0; kind < 6; ++kind) {
    for (const std::uint32_t size : {1U, 2U, 7U, 100U, 1000U}) {
      std::vector<Neighbour> all;
      for (std::uint32_t i = 0; i < size; ++i) {
        all.push_back({squared(kind, i), i});
      }
      std::vector<Neighbour> sorted = all;
      std::sort(sorted.begin(), sorted.end());
      for (std::uint32_t count = 1; count < size; count += 1 + size / 50) {
        std::vector<Neighbour> found = all;
        keep_nearest(count, found);
        ASSERT_EQ(sorted_indices(found), sorted_indices({sorted.begin(), sorted.begin() + count}))
            << kind << ", " << count << " of " << size;
      }
    }
  }
}

TEST(DisjointSets, DoNotDependOnThreads) {
  constexpr std::uint32_t kCount = 30000;
  DisjointSets sets(kCount);
  tbb::parallel_for(std::uint32_t{0}, kCount, [&](std::uint32_t i) {
    sets.join(i, (i + 300) % kCount);
    sets.join(i, i - i % 3);
  });
  for (std::uint32_t i = 0; i < kCount; ++i) {
    ASSERT_EQ(sets.find(i), i % 300 / 3 * 3);
  }
}

}  // namespace
}  // namespace tactree::builder
