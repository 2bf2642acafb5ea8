#include "cleaning/outliers.hpp"

#include <algorithm>

namespace tactree::builder {
namespace {

constexpr double kCellSpacings = 10.0;
constexpr std::size_t kCompany = 8;

std::size_t count_around(const ZOrderedCloud& points, const Eigen::Vector3i& cell, int level) {
  const int cells = 1 << level;
  std::size_t count = 0;
  for (int k = 0; k < 27; ++k) {
    const Eigen::Vector3i at = cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if ((at.array() >= 0).all() && (at.array() < cells).all()) {
      count += points.find(at, level).count();
    }
  }
  return count;
}

std::vector<std::uint32_t> in_company_at(const ZOrderedCloud& points, int level) {
  const std::size_t company = std::min(kCompany, points.size() / 32);
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  for (const CellRange& range : points.cells(level)) {
    if (range.count() <= company &&
        count_around(points, points.cell_of(range.first, level), level) <= company) {
      continue;
    }
    for (std::uint32_t i = range.first; i < range.last; ++i) {
      kept.push_back(i);
    }
  }
  return kept;
}

}  // namespace

Box plausible_box(std::span<const Eigen::Vector3d> positions, double margin) {
  const std::size_t n = positions.size();
  if (n < 8) {
    return {};
  }
  const std::size_t beyond = std::max(std::min<std::size_t>(10, n / 8), n / 100);
  Box box(Eigen::Vector3d::Zero().eval(), Eigen::Vector3d::Zero().eval());
  std::vector<double> values(n);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < n; ++i) {
      values[i] = positions[i][axis];
    }
    const auto low = values.begin() + static_cast<std::ptrdiff_t>(beyond);
    const auto high = values.begin() + static_cast<std::ptrdiff_t>(n - 1 - beyond);
    std::nth_element(values.begin(), low, values.end());
    box.min()[axis] = *low;
    std::nth_element(low, high, values.end());
    box.max()[axis] = *high;
  }
  const double edge = largest_edge(box);
  if (!(edge > 0.0)) {
    return {};
  }
  box.min().array() -= margin * edge;
  box.max().array() += margin * edge;
  return box;
}

std::vector<std::uint32_t> points_in_company(const ZOrderedCloud& points, double spacing) {
  const std::size_t few = std::max<std::size_t>(10, points.size() / 1000);
  std::vector<std::uint32_t> kept;
  for (int level = points.level_for_edge(kCellSpacings * spacing);; --level) {
    kept = in_company_at(points, level);
    if (level == 0 || points.size() - kept.size() <= few) {
      break;
    }
  }
  return kept;
}

}  // namespace tactree::builder
