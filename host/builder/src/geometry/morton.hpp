#pragma once
// Z-order (Morton) codes: the bits of three cell coordinates interleaved. Sorting by the code sorts
// by octant at every level of an octree over the cells.

#include <Eigen/Core>
#include <cstdint>

namespace tactree::builder {

/// Bits of a coordinate, and levels of the octree over the cells below its root.
inline constexpr int kMortonLevels = 21;

/// Interleaves the low 21 bits of three non-negative coordinates, x lowest.
[[nodiscard]] std::uint64_t morton_code(const Eigen::Vector3i& cell);
/// The inverse of morton_code().
[[nodiscard]] Eigen::Vector3i morton_cell(std::uint64_t code);

}  // namespace tactree::builder
