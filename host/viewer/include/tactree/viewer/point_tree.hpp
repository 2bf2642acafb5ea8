#pragma once
// A model's points by level of detail, for pages that show millions of points: an octree whose
// nodes hold some thousands of points each, spread over the node's cube. The root is a coarse
// picture of the model, and each level adds points. No point is in two nodes.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/model/blob.hpp"

namespace tactree::viewer {

/// Points per node; nodes on the deepest level hold all remaining points.
inline constexpr std::uint32_t kPointsPerNode = 8192;
inline constexpr std::uint32_t kMaxNodeLevel = 12;  ///< levels below the root

/// A point as it is transmitted, little-endian: x, y, z from the node's lower corner in units of
/// 1/65535 of its edge, then the normal in octahedral encoding with 8 bits per axis.
using PackedPoint = std::array<std::uint16_t, 4>;

using Rgb = std::array<std::uint8_t, 3>;

struct PointNode {
  std::array<float, 3> min_m{};  ///< lower corner
  float edge_m = 0.0F;
  float spacing_m = 0.0F;  ///< approximate distance between points of this node and its ancestors
  std::uint32_t first_point = 0;
  std::uint32_t point_count = 0;
  std::vector<std::uint32_t> children;  ///< indices, greater than the index of the node
};

class PointTree {
 public:
  /// `colours` is empty, or has one element per point of the blob. Cost: about 0.2 us and 8 bytes
  /// per point, 1 more with materials and 3 more with colours.
  explicit PointTree(const core::BlobView& view, std::span<const Rgb> colours = {});

  [[nodiscard]] const std::vector<PointNode>& nodes() const { return nodes_; }
  /// Precondition: node < nodes().size().
  [[nodiscard]] std::span<const PackedPoint> points(std::size_t node) const;
  /// The index of the material of each of these points; empty for a model with fewer than two.
  [[nodiscard]] std::span<const std::uint8_t> materials(std::size_t node) const;
  /// The colour of each of these points in the scan; empty if it is unknown.
  [[nodiscard]] std::span<const Rgb> colours(std::size_t node) const;
  [[nodiscard]] bool has_colours() const { return !colours_.empty(); }

 private:
  struct Task;
  class Build;

  std::vector<PointNode> nodes_;
  std::vector<PackedPoint> points_;
  std::vector<std::uint8_t> materials_;  // empty, or one per point
  std::vector<Rgb> colours_;             // empty, or one per point
};

/// Name and colour of a material, which a blob does not store.
struct MaterialLabel {
  std::string name;
  std::optional<std::array<std::uint8_t, 3>> colour{};  ///< R, G, B of its points in the scan
};

/// A frequent colour of the scan.
struct ScanColour {
  std::array<std::uint8_t, 3> rgb{};
  std::uint64_t points = 0;
};

/// What a blob does not store, for the page.
struct ScanFacts {
  std::vector<MaterialLabel> labels{};  ///< one per material, or empty
  std::vector<ScanColour> colours{};
  std::vector<Rgb> point_colours{};  ///< one per point of the blob, or empty
};

/// The nodes without their points, the materials with their numbers of points, and the colours of
/// the scan, as JSON.
[[nodiscard]] std::string tree_json(const PointTree& tree, const core::BlobView& view,
                                    const ScanFacts& scan = {});

/// Cubes of a blob's octree on one level, by their lower corners, m.
struct OctantBoxes {
  std::uint32_t level = 0;
  float edge_m = 0.0F;
  std::vector<std::array<float, 3>> corners_m;
};
/// Cubes of the deepest level that is at most `level` and has at most `max_cubes` cubes, or of
/// level 0. OctantBoxes::level is the chosen level.
[[nodiscard]] OctantBoxes octant_boxes(const core::BlobView& view, std::uint32_t level,
                                       std::size_t max_cubes);

}  // namespace tactree::viewer
