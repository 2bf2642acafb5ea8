#pragma once
// Determines where the material of a scanned object is: on the inner side of its surface, where the
// surface encloses something. A sheet has no material, and both its sides are free.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/winding_tree.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::builder {

struct OrientedPoints {
  std::span<const Eigen::Vector3d> positions;
  std::span<const Eigen::Vector3f> normals;
  std::span<const std::uint8_t>
      doubtful;  ///< empty, or one per position: 1 if its orientation is ambiguous
  double spacing = 0.0;
};

class Interior {
 public:
  /// Points closer than two spacings whose normals agree belong to one component. A component has
  /// material behind it if the mean winding number at its points is large enough: this is true for
  /// a body with holes, and false for a sheet, a flat bowl or a component with ambiguous
  /// orientation. Deterministic. Cost: about 3 us per point and core.
  explicit Interior(const OrientedPoints& points);

  /// True if there is material behind the point.
  [[nodiscard]] bool is_backed(std::uint32_t point) const { return backed_[point] != 0; }
  [[nodiscard]] double backed_share() const { return backed_share_; }
  /// True if there is material at a position that is farther from all points than one to two
  /// spacings. Cost: about 5 us.
  [[nodiscard]] bool is_material(const Eigen::Vector3d& at) const;

 private:
  void find_bodies(const OrientedPoints& points, std::span<const std::uint32_t> piece_of);

  WindingTree tree_;
  std::vector<std::uint8_t> backed_;
  double backed_share_ = 0.0;
  double outermost_ = 0.0;  // winding number far away from the surface: 1 if material is there
};

struct Octree;

/// The bytes of a blob's section `interior`; empty if no point has material behind it.
[[nodiscard]] std::vector<std::uint8_t> interior_bytes(const Interior& interior,
                                                       const Octree& tree);
/// What a blob with this tree has more if its points have material behind them: the section, and
/// the extension of the header.
[[nodiscard]] std::uint64_t interior_bytes_max(const Octree& tree);

}  // namespace tactree::builder
