#include "geometry/spacing.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactree::builder {
namespace {

constexpr std::size_t kSpacingSamples = 4096;
constexpr std::size_t kNeighbours = 16;
constexpr double kTrusted = 0.98;  // ratio of the sample that is used; the rest may be outliers

}  // namespace

double coarse_cell_edge(const ZOrderedCloud& points) {
  const std::vector<std::size_t> counts = points.count_cells();
  int level = ZOrderedCloud::kFinestLevel;
  while (level > 0 && counts[static_cast<std::size_t>(level)] * kNeighbours > points.size()) {
    --level;
  }
  return points.cell_edge(level);
}

SpacingEstimate estimate_spacing(const ZOrderedCloud& points) {
  if (points.size() < 2) {
    return {};
  }
  const double guess = coarse_cell_edge(points);
  const bool few = points.size() < 2 * kNeighbours;
  const std::size_t neighbours = few ? 1 : kNeighbours;
  const std::size_t stride = 1 + (points.size() - 1) / kSpacingSamples;
  std::vector<double> areas((points.size() + stride - 1) / stride);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, areas.size(), 16), [&](auto range) {
    std::vector<Neighbour> found;
    for (std::size_t s = range.begin(); s < range.end(); ++s) {
      points.find_nearest(points.positions()[s * stride], neighbours + 1, guess, found);
      // The disc up to the last neighbour contains the point itself, all other neighbours and half
      // of the last one.
      const double per_square = few ? 1.0 : std::numbers::pi / (kNeighbours + 0.5);
      areas[s] = per_square * found.back().squared_distance;
    }
  });
  std::sort(areas.begin(), areas.end());
  const auto trusted = static_cast<std::size_t>(kTrusted * static_cast<double>(areas.size()));
  double sum = 0.0;
  for (std::size_t s = 0; s <= trusted && s < areas.size(); ++s) {
    sum += areas[s];
  }
  const auto counted = static_cast<double>(std::min(trusted + 1, areas.size()));
  const double median = areas[(areas.size() - 1) / 2];
  const double dense = areas[areas.size() / 10];
  return {std::sqrt(median), std::sqrt(sum / counted), dense > 0.0 ? median / dense : 1.0};
}

}  // namespace tactree::builder
