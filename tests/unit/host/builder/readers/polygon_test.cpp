#include "polygon.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

namespace tactree::builder {
namespace {

using Points = std::vector<Eigen::Vector3d>;

std::vector<std::uint32_t> all_of(const Points& points) {
  std::vector<std::uint32_t> corners(points.size());
  std::iota(corners.begin(), corners.end(), 0U);
  return corners;
}

/// The areas along z of the triangles, each with the sign of its winding.
std::vector<double> areas(const Points& points) {
  PolygonCutter cutter(points);
  std::vector<double> result;
  for (const auto& t : cutter.cut(all_of(points))) {
    result.push_back((points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]).z() / 2);
  }
  return result;
}

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double sum_of_sizes(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0,
                         [](double total, double value) { return total + std::abs(value); });
}

TEST(Polygon, CutsConvexIntoFan) {
  const Points points = {{0, 0, 0}, {2, 0, 0}, {3, 1, 0}, {2, 2, 0}, {0, 2, 0}};
  PolygonCutter cutter(points);
  const auto triangles = cutter.cut(all_of(points));
  ASSERT_EQ(triangles.size(), 3U);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(triangles[i], (PolygonCutter::Triangle{0, i + 1, i + 2}));
  }
}

TEST(Polygon, ConcaveStaysInside) {
  // An L whose first corner gives a fan outside of it; both windings, far from the origin.
  Points points = {{0, 2, 0}, {0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}};
  for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(6e5, 5e6, 0);
  EXPECT_NEAR(sum(areas(points)), 3.0, 1e-9);
  EXPECT_NEAR(sum_of_sizes(areas(points)), 3.0, 1e-9);
  std::reverse(points.begin(), points.end());
  EXPECT_NEAR(sum(areas(points)), -3.0, 1e-9);
  EXPECT_NEAR(sum_of_sizes(areas(points)), 3.0, 1e-9);
}

TEST(Polygon, CutsArrowheadInside) {
  const Points points = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {1, 1, 0}};
  EXPECT_NEAR(sum_of_sizes(areas(points)), 1.0, 1e-12);
}

TEST(Polygon, CutsCombOfManyTeeth) {
  Points points;
  for (int i = 0; i < 50; ++i) {
    points.emplace_back(2 * i, 10, 0);
    points.emplace_back(2 * i + 1, 1, 0);
  }
  points.emplace_back(100, 0, 0);
  points.emplace_back(0, 0, 0);
  std::reverse(points.begin(), points.end());
  const std::vector<double> parts = areas(points);
  EXPECT_EQ(parts.size(), points.size() - 2);
  EXPECT_NEAR(std::abs(sum(parts)), sum_of_sizes(parts), 1e-9);
}

TEST(Polygon, CutsSelfCrossingCompletely) {
  Points points;
  for (int i = 0; i < 5; ++i) points.emplace_back(std::cos(2.513 * i), std::sin(2.513 * i), 0);
  EXPECT_EQ(areas(points).size(), 3U);
  const Points collapsed(7, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(areas(collapsed).size(), 5U);
}

}  // namespace
}  // namespace tactree::builder
