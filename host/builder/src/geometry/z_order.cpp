#include "geometry/z_order.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <cmath>

#include "geometry/keyed_points.hpp"

namespace tactree::builder {
namespace {

bool lexicographically_less(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a[axis] != b[axis]) {
      return a[axis] < b[axis];
    }
  }
  return false;
}

// The n-th smallest of at least n squared distances, n > 0. Those of points on a surface are spread
// evenly, so two interpolations leave few candidates. Reorders `values`.
double nth_smallest(std::vector<double>& values, std::size_t n) {
  double low = 0.0;
  double high = *std::max_element(values.begin(), values.end());
  std::size_t below = 0;             // values of at most `low`
  std::size_t most = values.size();  // of at most `high`
  const double margin = 1.0 + 0.5 * std::sqrt(static_cast<double>(values.size()));
  for (const double aim : {margin, -margin}) {
    const double part = (static_cast<double>(n) + aim - static_cast<double>(below)) /
                        static_cast<double>(most - below);
    const double middle = low + std::clamp(part, 0.0, 1.0) * (high - low);
    std::size_t count = 0;
    for (const double value : values) {
      count += value <= middle ? 1U : 0U;
    }
    if (count >= n) {
      high = middle;
      most = count;
    } else {
      low = middle;
      below = count;
    }
  }
  std::size_t left = 0;
  for (const double value : values) {
    values[left] = value;
    left += value <= high && (below == 0 || value > low) ? 1U : 0U;
  }
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(n - 1 - below);
  std::nth_element(values.begin(), nth, values.begin() + static_cast<std::ptrdiff_t>(left));
  return *nth;
}

}  // namespace

void keep_nearest(std::size_t count, std::vector<Neighbour>& found) {
  if (count == 0 || count >= found.size()) {
    found.resize(std::min(count, found.size()));
    return;
  }
  thread_local std::vector<double> distances;
  distances.clear();
  for (const Neighbour& n : found) {
    distances.push_back(n.squared_distance);
  }
  std::erase_if(found, [farthest = nth_smallest(distances, count)](const Neighbour& n) {
    return n.squared_distance > farthest;
  });
  if (found.size() > count) {  // several at that distance
    std::sort(found.begin(), found.end());
    found.resize(count);
  }
}

ZOrderedCloud::ZOrderedCloud(Cloud cloud) : cloud_(std::move(cloud)) {
  const Box box = bounds_of(cloud_.positions);
  origin_ = box.isEmpty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(box.min());
  edge_ = largest_edge(box);
  edge_ = edge_ > 0.0 ? edge_ * (1.0 + 1e-9) : 1.0;
  reorder(cloud_, sorted());
  codes_.resize(size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size(), 4096), [&](auto range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      codes_[i] = morton_code(finest_cell(cloud_.positions[i]));
    }
  });
  index();
}

std::vector<std::uint32_t> ZOrderedCloud::sorted() const {
  std::vector<KeyedPoint> entries = keyed_points(
      cloud_.positions, [&](const Eigen::Vector3d& position) { return finest_cell(position); });
  tbb::parallel_sort(entries.begin(), entries.end(), [&](const KeyedPoint& a, const KeyedPoint& b) {
    if (a.code != b.code) {
      return a.code < b.code;
    }
    const Eigen::Vector3d& p = cloud_.positions[a.index];
    const Eigen::Vector3d& q = cloud_.positions[b.index];
    return lexicographically_less(p, q) || (a.index < b.index && !lexicographically_less(q, p));
  });
  std::vector<std::uint32_t> order(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    order[i] = entries[i].index;
  }
  return order;
}

void ZOrderedCloud::index() {
  // At most one cell for two points.
  constexpr int kMostLevels = 8;
  coarse_level_ = 0;
  while (coarse_level_ < kMostLevels && std::size_t{16} << 3 * coarse_level_ <= codes_.size()) {
    ++coarse_level_;
  }
  const std::size_t cells = std::size_t{1} << 3 * coarse_level_;
  const int shift = 3 * (kFinestLevel - coarse_level_);
  coarse_.clear();
  coarse_.reserve(cells + 1);
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    coarse_.resize(std::max(coarse_.size(), (codes_[i] >> shift) + 1),
                   static_cast<std::uint32_t>(i));
  }
  coarse_.resize(cells + 1, static_cast<std::uint32_t>(codes_.size()));
}

ZOrderedCloud ZOrderedCloud::subset(std::span<const std::uint32_t> indices) const {
  ZOrderedCloud chosen;
  chosen.cloud_ = select(cloud_, indices);
  chosen.origin_ = origin_;
  chosen.edge_ = edge_;
  chosen.codes_.reserve(indices.size());
  for (const std::uint32_t i : indices) {
    chosen.codes_.push_back(codes_[i]);
  }
  chosen.index();
  return chosen;
}

void ZOrderedCloud::keep(std::span<const std::uint32_t> indices) {
  builder::keep(cloud_, indices);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    codes_[k] = codes_[indices[k]];
  }
  codes_.resize(indices.size());
  index();
}

void ZOrderedCloud::transform(const Eigen::Vector3d& origin, double factor) {
  for (Eigen::Vector3d& p : cloud_.positions) {
    p = factor * (p - origin);
  }
  origin_ = factor * (origin_ - origin);
  edge_ *= factor;
  // Rounding may move a position to another cell: recompute the codes.
  *this = ZOrderedCloud(std::move(cloud_));
}

double ZOrderedCloud::cell_edge(int level) const { return std::ldexp(edge_, -level); }

int ZOrderedCloud::level_for_edge(double edge) const {
  if (!(edge < edge_)) {
    return 0;
  }
  const int level = edge > 0.0 ? std::ilogb(edge_ / edge) : kFinestLevel;
  return std::clamp(level, 0, kFinestLevel);
}

std::vector<CellRange> ZOrderedCloud::cells(int level) const {
  const int shift = 3 * (kFinestLevel - level);
  std::vector<CellRange> ranges;
  for (std::uint32_t i = 0; i < codes_.size(); ++i) {
    if (i == 0 || codes_[i] >> shift != codes_[i - 1] >> shift) {
      ranges.push_back({i, i});
    }
    ranges.back().last = i + 1;
  }
  return ranges;
}

Eigen::Vector3i ZOrderedCloud::cell_of(std::uint32_t point, int level) const {
  return morton_cell(codes_[point] >> (3 * (kFinestLevel - level)));
}

CellRange ZOrderedCloud::find(const Eigen::Vector3i& cell, int level) const {
  const int shift = 3 * (kFinestLevel - level);
  const std::uint64_t low = morton_code(cell) << shift;
  const std::uint64_t high = low | ((std::uint64_t{1} << shift) - 1);
  const int coarse_shift = 3 * (kFinestLevel - coarse_level_);
  const auto at = [&](std::size_t i) { return codes_.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto end_of = [&](std::uint64_t code) { return at(coarse_[(code >> coarse_shift) + 1]); };
  const auto first = std::lower_bound(at(coarse_[low >> coarse_shift]), end_of(low), low);
  // Cells are small relative to the cloud, so their end is found by exponential search.
  const auto end = end_of(high);
  const auto left = static_cast<std::size_t>(end - first);
  std::size_t step = 1;
  while (step <= left && first[static_cast<std::ptrdiff_t>(step - 1)] <= high) {
    step *= 2;
  }
  const auto last =
      std::upper_bound(first + static_cast<std::ptrdiff_t>(step / 2),
                       first + static_cast<std::ptrdiff_t>(std::min(step - 1, left)), high);
  return {static_cast<std::uint32_t>(first - codes_.begin()),
          static_cast<std::uint32_t>(last - codes_.begin())};
}

std::vector<std::size_t> ZOrderedCloud::count_cells() const {
  return builder::count_cells(codes_.size(), [&](std::size_t i) { return codes_[i]; });
}

void ZOrderedCloud::find_nearest(const Eigen::Vector3d& centre, std::size_t count, double guess,
                                 std::vector<Neighbour>& found) const {
  find_nearest_unsorted(centre, count, guess, found);
  std::sort(found.begin(), found.end());
}

void ZOrderedCloud::find_nearest_unsorted(const Eigen::Vector3d& centre, std::size_t count,
                                          double guess, std::vector<Neighbour>& found) const {
  const double everywhere = 4.0 * edge_ + 2.0 * (centre - origin_).norm();
  double radius = guess > 0.0 ? std::min(guess, everywhere) : everywhere;
  count = std::min(count, size());
  while (true) {
    found.clear();
    visit_within(centre, radius, [&](std::uint32_t i, double squared) {
      found.push_back({squared, i});
    });
    if (found.size() >= count || radius >= everywhere) {
      break;
    }
    radius = std::min(2.0 * radius, everywhere);
  }
  keep_nearest(count, found);
}

Eigen::Vector3i ZOrderedCloud::finest_cell(const Eigen::Vector3d& position) const {
  constexpr double kCells = 1 << kFinestLevel;
  return ((position - origin_).array() * (kCells / edge_)).max(0.0).min(kCells - 1.0).cast<int>();
}

std::uint64_t drop_duplicates(ZOrderedCloud& points) {
  const auto known = [&](std::uint32_t i) {
    return points.cloud().has_normals() && !points.normals()[i].isZero();
  };
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (kept.empty() || points.positions()[i] != points.positions()[kept.back()]) {
      kept.push_back(i);
    } else if (known(i) && !known(kept.back())) {
      kept.back() = i;
    }
  }
  const std::uint64_t dropped = points.size() - kept.size();
  if (dropped > 0) {
    points.keep(kept);
  }
  return dropped;
}

}  // namespace tactree::builder
