#pragma once
// A model's points by level of detail, for a page that shows millions of them: an octree whose
// every node holds some thousands of points spread over its cube. The root alone is a coarse
// picture of the whole; each level below adds points, nowhere one that is above it already.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/blob.hpp"

namespace tactree::viewer {

/// Points of a node, but for nodes on the deepest level: there all that are left.
inline constexpr std::uint32_t kPointsPerNode = 8192;
inline constexpr std::uint32_t kDeepestNode = 12;  ///< levels below the root

/// As it is sent, little-endian: x, y, z as shares of the node's edge from its lower corner, in
/// 1/65535; then the normal, octahedral, 8 bits each way.
using PackedPoint = std::array<std::uint16_t, 4>;

struct PointNode {
  std::array<float, 3> min_m{};  ///< lower corner
  float edge_m = 0.0F;
  float spacing_m = 0.0F;  ///< about; between points of this node and those above it
  std::uint32_t first_point = 0;
  std::uint32_t point_count = 0;
  std::vector<std::uint32_t> children;  ///< their numbers; children follow their parents
};

class PointTree {
 public:
  /// Cost: about 0.2 us a point; 8 bytes a point stay.
  explicit PointTree(const core::BlobView& view);

  [[nodiscard]] const std::vector<PointNode>& nodes() const { return nodes_; }
  /// Precondition: node < nodes().size().
  [[nodiscard]] std::span<const PackedPoint> points(std::size_t node) const;

 private:
  struct Task;
  class Build;

  std::vector<PointNode> nodes_;
  std::vector<PackedPoint> points_;
};

/// The nodes, without their points, as JSON: what the page plans with.
[[nodiscard]] std::string tree_json(const PointTree& tree, const core::BlobView& view);

/// Cubes of the blob's own octree on one level: x, y, z of the lower corner (m, float32 each).
/// More than `most` cubes: the level above, and so on. `level` is the one that was taken.
struct OctantBoxes {
  std::uint32_t level = 0;
  float edge_m = 0.0F;
  std::vector<std::array<float, 3>> corners_m;
};
[[nodiscard]] OctantBoxes octant_boxes(const core::BlobView& view, std::uint32_t level,
                                       std::size_t most);

}  // namespace tactree::viewer
