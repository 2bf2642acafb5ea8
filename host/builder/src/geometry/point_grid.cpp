#include "geometry/point_grid.hpp"

#include <algorithm>
#include <bit>

#include "geometry/keyed_points.hpp"

namespace tactree::builder {
namespace {

constexpr double kMaxCellsPerAxis = 1048576.0;

// Mixes all bits of a code into the low ones (the finaliser of splitmix64).
std::uint64_t mix(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9U;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBU;
  return v ^ (v >> 31);
}

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3d> positions, double cell_edge)
    : edge_(cell_edge) {
  if (!positions.empty()) {
    Eigen::Vector3d low = positions[0];
    Eigen::Vector3d high = positions[0];
    for (const Eigen::Vector3d& p : positions) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    origin_ = low;
    edge_ = std::max(edge_, (high - low).maxCoeff() / (kMaxCellsPerAxis - 2.0));
    size_ = cell_at(high).array() + 1;
  }
  const std::vector<KeyedPoint> entries =
      sorted_points(positions, [&](const Eigen::Vector3d& position) { return cell_at(position); });

  order_.resize(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    order_[i] = entries[i].index;
    if (i == 0 || entries[i].code != entries[i - 1].code) {
      codes_.push_back(entries[i].code);
      first_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  first_.push_back(static_cast<std::uint32_t>(entries.size()));

  table_.assign(std::bit_ceil(2 * codes_.size() + 1), 0);
  for (std::size_t cell = 0; cell < codes_.size(); ++cell) {
    std::size_t slot = mix(codes_[cell]) & (table_.size() - 1);
    while (table_[slot] != 0) {
      slot = (slot + 1) & (table_.size() - 1);
    }
    table_[slot] = static_cast<std::uint32_t>(cell + 1);
  }
}

std::size_t PointGrid::find(const Eigen::Vector3i& cell) const {
  if ((cell.array() < 0).any() || (cell.array() >= size_.array()).any()) {
    return kNone;
  }
  const std::uint64_t code = morton_code(cell);
  std::size_t slot = mix(code) & (table_.size() - 1);
  while (table_[slot] != 0) {
    const std::size_t found = table_[slot] - 1;
    if (codes_[found] == code) {
      return found;
    }
    slot = (slot + 1) & (table_.size() - 1);
  }
  return kNone;
}

// Clamps the cell of a position to the grid. Lower limits (`beyond` is 0) are clamped to 0 .. size,
// upper limits (`beyond` is -1) to -1 .. size - 1, so that a range outside the grid is empty.
Eigen::Vector3i PointGrid::clamped_cell(const Eigen::Vector3d& position, int beyond) const {
  const Eigen::Array3d cell = ((position - origin_) / edge_).array().floor();
  const Eigen::Array3d least = Eigen::Array3d::Constant(beyond == 0 ? 0.0 : -1.0);
  const Eigen::Array3d most = size_.cast<double>().array() + (beyond == 0 ? 0.0 : -1.0);
  return cell.max(least).min(most).cast<int>();
}

}  // namespace tactree::builder
