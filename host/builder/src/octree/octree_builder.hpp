#pragma once
// Quantised points in depth-first leaf order, and the octree over them.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "octree/lattice.hpp"

namespace tactree::builder {

struct BuiltLeaf {
  core::Int3 min{};  ///< lattice units
  std::uint32_t level = 0;
  std::uint32_t first = 0;  ///< index into Octree::order
  std::uint32_t count = 0;
};

struct Octree {
  Lattice lattice;
  std::vector<core::BlobNode> nodes;
  std::vector<BuiltLeaf> leaves;     ///< by leaf number
  std::vector<std::uint32_t> order;  ///< position indices, leaf by leaf, words ascending
  std::vector<std::uint32_t> words;  ///< position bits of the point words, parallel to `order`
  std::uint64_t merged = 0;          ///< points dropped at an occupied site
};

/// Splits the root until a leaf holds at most `leaf_points` points or has the finest edge of the
/// lattice; 0 splits every leaf down to the finest edge. Keeps the first of several points at one
/// lattice site. With one unit normal per position, a position is rounded to a site near its
/// tangent plane (rounding.hpp); without, to the site that contains it.
[[nodiscard]] Octree build_octree(std::span<const Eigen::Vector3d> positions,
                                  std::span<const Eigen::Vector3f> normals, const Lattice& lattice,
                                  std::uint32_t leaf_points);

/// The neighbours of the leaves, six entries per leaf; encoding: blob_format.hpp.
[[nodiscard]] std::vector<std::uint32_t> neighbour_table(const Octree& tree);

}  // namespace tactree::builder
