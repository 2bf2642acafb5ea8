#include "geometry/z_order.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "shapes.hpp"

namespace tactree::builder {
namespace {

TEST(ZOrder, TilesPointsAtEveryLevel) {
  const ZOrderedCloud points(random_sphere(5000, 0.1));
  const std::vector<std::size_t> counts = points.count_cells();
  for (int level = 0; level <= 12; ++level) {
    std::uint32_t next = 0;
    std::set<std::tuple<int, int, int>> seen;
    for (const CellRange& range : points.cells(level)) {
      ASSERT_EQ(range.first, next);
      next = range.last;
      const Eigen::Vector3i cell = points.cell_of(range.first, level);
      ASSERT_TRUE(seen.emplace(cell.x(), cell.y(), cell.z()).second);
      const CellRange found = points.find(cell, level);
      ASSERT_EQ(found.first, range.first);
      ASSERT_EQ(found.last, range.last);
      const Box box(points.cell_corner(cell, level),
                    (points.cell_corner(cell, level).array() + points.cell_edge(level)).matrix());
      ASSERT_LT(box.exteriorDistance(points.positions()[range.first]), 1e-12);
    }
    EXPECT_EQ(next, points.size());
    EXPECT_EQ(counts[static_cast<std::size_t>(level)], seen.size());
  }
}

TEST(ZOrder, VisitsPointsWithinRadius) {
  const ZOrderedCloud points(random_sphere(3000, 1.0));
  for (std::uint64_t q = 0; q < 200; ++q) {
    const Eigen::Vector3d centre(3.0 * unit_random(3 * q) - 1.5, 3.0 * unit_random(3 * q + 1) - 1.5,
                                 3.0 * unit_random(3 * q + 2) - 1.5);
    const double radius = std::pow(10.0, 2.5 * unit_random(q + 999) - 2.0);
    std::multiset<std::uint32_t> visited;
    points.visit_within(centre, radius, [&](std::uint32_t i, double) { visited.insert(i); });
    std::multiset<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      if ((points.positions()[i] - centre).norm() <= radius) {
        expected.insert(i);
      }
    }
    ASSERT_EQ(visited, expected) << "query " << q;
  }
}

TEST(ZOrder, FindsNearestForAnyGuess) {
  const ZOrderedCloud points(random_sphere(2000, 1.0));
  std::vector<Neighbour> all;
  std::vector<Neighbour> found;
  for (std::uint64_t q = 0; q < 60; ++q) {
    const Eigen::Vector3d centre(4.0 * unit_random(3 * q) - 2.0, unit_random(3 * q + 1),
                                 unit_random(3 * q + 2));
    all.clear();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      all.push_back({(points.positions()[i] - centre).squaredNorm(), i});
    }
    std::sort(all.begin(), all.end());
    for (const double guess : {0.0, 1e-9, 0.1, 1e9}) {
      points.find_nearest(centre, 17, guess, found);
      ASSERT_EQ(found.size(), 17U);
      for (std::size_t k = 0; k < found.size(); ++k) {
        ASSERT_EQ(found[k].index, all[k].index) << "guess " << guess;
      }
    }
  }
  points.find_nearest(Eigen::Vector3d::Zero(), 5000, 0.1, found);
  EXPECT_EQ(found.size(), points.size());
}

// A cloud whose attributes all tell the position of their point.
Cloud telling_cloud(std::size_t n) {
  Cloud cloud = random_sphere(n, 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f p = cloud.positions[i].cast<float>();
    const auto step = [&](int axis) {
      return static_cast<std::uint8_t>(100.0F * (p[axis] + 1.0F));
    };
    cloud.normals[i] = p;
    cloud.materials.push_back(step(0));
    cloud.doubtful.push_back(step(1));
    cloud.sights.push_back({-p, p.z() > 0.0F});
    cloud.colours.push_back({step(0), step(1), step(2)});
  }
  return cloud;
}

void expect_same(const Cloud& a, const Cloud& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.doubtful, b.doubtful);
  EXPECT_EQ(a.colours, b.colours);
  ASSERT_EQ(a.sights.size(), b.sights.size());
  for (std::size_t i = 0; i < a.sights.size(); ++i) {
    EXPECT_EQ(a.sights[i].toward, b.sights[i].toward);
    EXPECT_EQ(a.sights[i].sure, b.sights[i].sure);
  }
}

TEST(ZOrder, SortsAllAttributesOfPoints) {
  const Cloud cloud = telling_cloud(9000);
  std::map<std::array<double, 3>, std::uint32_t> index;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d& p = cloud.positions[i];
    index[{p.x(), p.y(), p.z()}] = i;
  }
  const ZOrderedCloud points(cloud);
  ASSERT_EQ(points.size(), cloud.size());
  std::vector<std::uint32_t> order;
  for (const Eigen::Vector3d& p : points.positions()) {
    order.push_back(index.at({p.x(), p.y(), p.z()}));
  }
  EXPECT_NE(points.positions(), cloud.positions);
  expect_same(points.cloud(), select(cloud, order));
}

TEST(ZOrder, KeepsTheSamePointsAsSubset) {
  ZOrderedCloud points(telling_cloud(9000));
  std::vector<std::uint32_t> indices;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (hash64(i) % 3 != 0) {
      indices.push_back(i);
    }
  }
  const ZOrderedCloud subset = points.subset(indices);
  points.keep(indices);
  ASSERT_EQ(points.size(), indices.size());
  expect_same(points.cloud(), subset.cloud());
  EXPECT_EQ(points.count_cells(), subset.count_cells());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const CellRange found = points.find(points.cell_of(i, 20), 20);
    ASSERT_TRUE(found.first <= i && i < found.last);
  }
}

TEST(ZOrder, DropsDuplicatesKeepingKnownNormals) {
  Cloud cloud = random_sphere(500, 1.0);
  const Cloud original = cloud;
  for (std::size_t i = 0; i < 100; ++i) {
    cloud.positions.push_back(cloud.positions[i]);
    cloud.normals.push_back(cloud.normals[i]);
    cloud.normals[i].setZero();
  }
  ZOrderedCloud points(std::move(cloud));
  EXPECT_EQ(drop_duplicates(points), 100U);
  EXPECT_EQ(points.size(), original.size());
  for (const Eigen::Vector3f& normal : points.normals()) {
    EXPECT_FALSE(normal.isZero());
  }
  EXPECT_EQ(drop_duplicates(points), 0U);
}

TEST(ZOrder, AcceptsEmptyAndDegenerateClouds) {
  const ZOrderedCloud none;
  EXPECT_TRUE(none.cells(3).empty());
  Cloud one;
  one.positions.assign(5, Eigen::Vector3d(1.0, 2.0, 3.0));
  ZOrderedCloud points(std::move(one));
  EXPECT_EQ(points.cells(21).size(), 1U);
  EXPECT_EQ(drop_duplicates(points), 4U);
}

}  // namespace
}  // namespace tactree::builder
