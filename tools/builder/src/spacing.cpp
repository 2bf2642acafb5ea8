#include "spacing.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactree::builder {
namespace {

constexpr std::size_t kSamples = 4096;
constexpr std::size_t kNeighbours = 16;

}  // namespace

double coarse_cell_edge(const ZOrderedCloud& points) {
  const std::vector<std::size_t> counts = points.count_cells();
  int level = ZOrderedCloud::kFinestLevel;
  while (level > 0 && counts[static_cast<std::size_t>(level)] * kNeighbours > points.size()) {
    --level;
  }
  return points.cell_edge(level);
}

double estimate_spacing(const ZOrderedCloud& points) {
  if (points.size() < 2) {
    return 0.0;
  }
  const double guess = coarse_cell_edge(points);
  const std::size_t neighbours = std::min(kNeighbours, points.size() - 1);
  const std::size_t stride = 1 + (points.size() - 1) / kSamples;
  std::vector<double> spacings((points.size() + stride - 1) / stride);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spacings.size(), 16), [&](auto range) {
    std::vector<Neighbour> found;
    for (std::size_t s = range.begin(); s < range.end(); ++s) {
      const Eigen::Vector3d& centre = points.positions()[s * stride];
      points.find_nearest(centre, neighbours + 1, guess, found);
      // The disc up to the last neighbour holds the point itself, all others but the last, and
      // half of that one.
      const double area = std::numbers::pi * found.back().squared_distance;
      spacings[s] = std::sqrt(area / (static_cast<double>(neighbours) + 0.5));
    }
  });
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

}  // namespace tactree::builder
