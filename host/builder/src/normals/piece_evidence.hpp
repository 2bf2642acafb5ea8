#pragma once
// Evidence about the outside of the components of a surface, at as many scales as each needs.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

struct PieceEvidence {
  std::uint32_t points = 0;
  std::uint32_t one_sided = 0;
  std::uint32_t two_sided = 0;
  bool settled = false;  ///< at some scale, few points are reached from both sides
  bool closed = false;   ///< settled at the finest scale
};

struct Evidence {
  std::vector<float> side;  ///< per point: 1 if its normal points outside, -1 if inside, 0: unknown
  std::vector<PieceEvidence> pieces;  ///< at the scale at which the component is settled
};

/// Finds for each point of `positions` the side that a ball reaches from outside without touching
/// `blockers`. The ball has the radius `finest`; components that it reaches from both sides are
/// tested with larger balls. `piece` is the number of the component of each point, below `pieces`.
[[nodiscard]] Evidence find_evidence(std::span<const Eigen::Vector3d> positions,
                                     std::span<const Eigen::Vector3f> normals,
                                     std::span<const std::uint32_t> piece, std::uint32_t pieces,
                                     std::span<const Eigen::Vector3d> blockers, double finest);

/// Winding number of an oriented cloud at a position: about 1 inside a body, 0 outside. Points of
/// the component `without` do not count. `area` is that of one point.
[[nodiscard]] double winding_number(const Eigen::Vector3d& at,
                                    std::span<const Eigen::Vector3d> positions,
                                    std::span<const Eigen::Vector3f> normals,
                                    std::span<const std::uint32_t> piece, std::uint32_t without,
                                    double area);

}  // namespace tactree::builder
