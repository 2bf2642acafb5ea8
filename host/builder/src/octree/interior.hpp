#pragma once
// Where the material of a scanned object is: on the inner side of its surface, as far as that
// encloses something. A sheet has none, and both its sides are free.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "tactree/core/model/blob_format.hpp"
#include "geometry/winding_tree.hpp"

namespace tactree::builder {

struct OrientedPoints {
  std::span<const Eigen::Vector3d> positions;
  std::span<const Eigen::Vector3f> normals;
  std::span<const std::uint8_t>
      doubtful;  ///< empty, or one per position: 1 if its side is doubtful
  double spacing = 0.0;
};

class Interior {
 public:
  /// Points closer than two spacings whose normals agree are one piece. A piece has material behind
  /// it if a winding number differs enough between its two sides and the rest of space: a body
  /// with holes does, a sheet or a flat bowl does not, nor does a piece that is doubtful.
  /// Deterministic. Cost: about 3 us per point and core.
  explicit Interior(const OrientedPoints& points);

  /// Is there material behind the point?
  [[nodiscard]] bool is_backed(std::uint32_t point) const { return backed_[point] != 0; }
  [[nodiscard]] double backed_share() const { return backed_share_; }
  /// Further from all points than a spacing or two. Cost: about 5 us.
  [[nodiscard]] bool is_material(const Eigen::Vector3d& at) const;

 private:
  void find_bodies(const OrientedPoints& points, std::span<const std::uint32_t> piece_of);

  WindingTree tree_;
  std::vector<std::uint8_t> backed_;
  double backed_share_ = 0.0;
  double outermost_ = 0.0;  // turns of space far away from the surface: 1 where that is material
};

struct Octree;

/// The bytes of a blob's section `interior`; empty if no point has material behind it.
[[nodiscard]] std::vector<std::uint8_t> interior_bytes(const Interior& interior,
                                                       const Octree& tree);

}  // namespace tactree::builder
