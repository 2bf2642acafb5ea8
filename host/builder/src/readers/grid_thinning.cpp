#include "grid_thinning.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "geometry/morton.hpp"

namespace tactree::builder {
namespace {

constexpr int kLevels = 21;             // of the octree over the cubes
constexpr std::size_t kSamples = 4096;  // that determine where most of the points are
constexpr std::size_t kBeyond = 100;    // 1 in this many may lie farther out, at each end
constexpr double kMargin = 10.0;        // around most of the points, in their largest extent

struct KeyedPoint {
  std::uint64_t code;
  std::uint32_t index;
  bool operator<(const KeyedPoint& other) const {
    return code != other.code ? code < other.code : index < other.index;
  }
};

struct Surroundings {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  double width = 0.0;
};

// Where most of the points are, with a margin.
Surroundings surroundings_of(std::span<const Eigen::Vector3d> positions) {
  const std::size_t stride = 1 + (positions.size() - 1) / kSamples;
  std::array<double, 3> high{};
  Surroundings around;
  double extent = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> sample;
    for (std::size_t i = 0; i < positions.size(); i += stride) {
      sample.push_back(positions[i][axis]);
    }
    std::sort(sample.begin(), sample.end());
    const std::size_t beyond = sample.size() / kBeyond;
    around.low[axis] = sample[beyond];
    high[static_cast<std::size_t>(axis)] = sample[sample.size() - 1 - beyond];
    extent = std::max(extent, high[static_cast<std::size_t>(axis)] - around.low[axis]);
  }
  // For points that all lie in one place, any width will do that the coordinates resolve.
  extent = std::max(extent, 1e-12 * std::max(around.low.cwiseAbs().maxCoeff(), 1e-12));
  around.low.array() -= kMargin * extent;
  around.width = (1.0 + 2.0 * kMargin) * extent;
  return around;
}

// The codes of the points in cubes of edge 2^exponent, sorted.
std::vector<KeyedPoint> sorted_codes(std::span<const Eigen::Vector3d> positions,
                                     const Eigen::Vector3d& low, int exponent) {
  // Cubes of all levels share their corners only if the origin is a corner of one of half the
  // width.
  const double block = std::ldexp(1.0, exponent + kLevels - 1);
  const Eigen::Array3d origin = (low.array() / block).floor() * block;
  const double per_unit = std::ldexp(1.0, -exponent);
  const double last = std::ldexp(1.0, kLevels) - 1.0;
  std::vector<KeyedPoint> points(positions.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](auto range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Eigen::Array3d cube = ((positions[i].array() - origin) * per_unit).max(0.0).min(last);
      points[i] = {morton_code(cube.cast<int>()), static_cast<std::uint32_t>(i)};
    }
  });
  tbb::parallel_sort(points.begin(), points.end());
  return points;
}

// The finest level with at most `most` occupied cubes; level 0 is one cube around all.
int finest_level(std::span<const KeyedPoint> points, std::size_t most) {
  // A point that begins a cube of some level begins one of all finer levels, too.
  std::array<std::size_t, kLevels + 1> begun{};
  begun[0] = 1;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const std::uint64_t differing = points[i].code ^ points[i - 1].code;
    if (differing != 0) {
      ++begun[static_cast<std::size_t>(kLevels - (63 - std::countl_zero(differing)) / 3)];
    }
  }
  int level = 0;
  std::size_t cubes = begun[0];
  while (level < kLevels && cubes + begun[static_cast<std::size_t>(level) + 1] <= most) {
    ++level;
    cubes += begun[static_cast<std::size_t>(level)];
  }
  return level;
}

}  // namespace

std::vector<std::uint8_t> GridThinning::select(std::span<const Eigen::Vector3d> positions,
                                               std::size_t most) {
  std::vector<std::uint8_t> kept(positions.size(), 0);
  if (positions.empty()) {
    return kept;
  }
  const Surroundings around = surroundings_of(positions);
  int finest = std::ilogb(around.width) + 2 - kLevels;  // 2^(kLevels - 1) cubes cover the width
  finest = std::max(finest, exponent_.value_or(finest));
  const std::vector<KeyedPoint> points = sorted_codes(positions, around.low, finest);
  const int level = finest_level(points, most);
  exponent_ = finest + kLevels - level;
  const int shift = 3 * (kLevels - level);
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
