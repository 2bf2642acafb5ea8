#include "grid_thinning.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "cleaning/outliers.hpp"
#include "geometry/keyed_points.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kSampled = 4096;  // points that determine where most of them are
constexpr double kMargin = 10.0;        // around these, in their largest extent
// Larger coordinates are damage; the difference of two could be infinite.
constexpr double kLargest = 1e100;

Eigen::Vector3d bounded(const Eigen::Vector3d& p) {
  return p.cwiseMax(-kLargest).cwiseMin(kLargest);
}

// Where most of the points are, with a margin.
Box surroundings_of(std::span<const Eigen::Vector3d> positions) {
  const std::size_t stride = 1 + (positions.size() - 1) / kSampled;
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < positions.size(); i += stride) {
    sample.push_back(bounded(positions[i]));
  }
  const Box box = plausible_box(sample, kMargin);
  const Box any = box.isEmpty() ? bounds_of(positions) : box;
  return {bounded(any.min()), bounded(any.max())};
}

// The width of the surroundings; if all points lie in one place, one that coordinates resolve.
double width_of(const Box& around) {
  const double size = around.min().cwiseAbs().maxCoeff();
  return std::max(largest_edge(around), 1e-12 * std::max(size, 1e-12));
}

// The points in the order of the cubes of edge 2^exponent; `low` is a corner of their surroundings.
std::vector<KeyedPoint> in_cubes(std::span<const Eigen::Vector3d> positions,
                                 const Eigen::Vector3d& low, int exponent) {
  // Cubes of all levels share their corners only if the origin is a corner of one of half the
  // width.
  const double block = std::ldexp(1.0, exponent + kMortonLevels - 1);
  const Eigen::Array3d origin = (low.array() / block).floor() * block;
  const double per_unit = std::ldexp(1.0, -exponent);
  const double last = std::ldexp(1.0, kMortonLevels) - 1.0;
  return sorted_points(positions, [&](const Eigen::Vector3d& p) -> Eigen::Vector3i {
    return ((bounded(p).array() - origin) * per_unit).max(0.0).min(last).cast<int>();
  });
}

}  // namespace

std::vector<std::uint8_t> GridThinning::select(std::span<const Eigen::Vector3d> positions,
                                               std::size_t most) {
  std::vector<std::uint8_t> kept(positions.size(), 0);
  if (positions.empty()) {
    return kept;
  }
  const Box around = surroundings_of(positions);
  int finest =
      std::ilogb(width_of(around)) + 2 - kMortonLevels;  // half of the cubes cover the width
  finest = std::max(finest, exponent_.value_or(finest));
  const std::vector<KeyedPoint> points = in_cubes(positions, around.min(), finest);
  const std::vector<std::size_t> cubes =
      count_cells(points.size(), [&](std::size_t i) { return points[i].code; });
  int level = kMortonLevels;
  while (level > 0 && cubes[static_cast<std::size_t>(level)] > most) {
    --level;
  }
  exponent_ = finest + kMortonLevels - level;
  const int shift = 3 * (kMortonLevels - level);
  for (std::size_t i = 0; i < points.size();) {
    std::uint32_t first = points[i].index;
    const std::uint64_t cube = points[i].code >> shift;
    for (; i < points.size() && points[i].code >> shift == cube; ++i) {
      first = std::min(first, points[i].index);
    }
    kept[first] = 1;
  }
  return kept;
}

double GridThinning::edge() const { return std::ldexp(1.0, exponent_.value_or(0)); }

}  // namespace tactree::builder
