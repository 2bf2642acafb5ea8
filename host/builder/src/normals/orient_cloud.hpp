#pragma once
// Decides the signs of the normals of a cloud from evidence about its outside.
//
//   1. The outside is the space that a ball of 2.5 spacings can reach from far away (outside.hpp).
//      A point that the ball touches from one side only faces that side. A component that it
//      touches from both sides has a hole: the ball is doubled until it does not pass the hole.
//   2. Neighbours whose relative signs are certain are joined to patches (signed_graph.hpp).
//   3. The patch with the strongest belief (its evidence and its decided neighbours) is decided
//      first.
//   4. Components that no ball reaches are enclosed: a winding number determines whether material
//      or empty space surrounds them. Components that are open at every scale are sheets: a rule
//      determines their orientation.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/z_order.hpp"
#include "tactree/builder/orientation.hpp"

namespace tactree::builder {

struct OrientationInput {
  const ZOrderedCloud& points;
  double spacing = 0.0;
  /// Cloud from which `points` was selected; may be empty if needs_dense() is false.
  const ZOrderedCloud& dense;
  double dense_spacing = 0.0;
  OrientationRule rule = OrientationRule::kAuto;
  std::span<const Eigen::Vector3d> viewpoints;  ///< positions of the scanner, model frame
  std::span<const std::uint8_t> given;          ///< empty, or per point: 1 if its normal was read
};

struct CloudOrientation {
  std::vector<OrientedPiece> pieces;   ///< largest first
  std::vector<std::uint8_t> doubtful;  ///< per point: 1 if its component has a low confidence
  std::uint64_t repaired = 0;          ///< given normals that were reversed
};

/// True if orient_cloud() reads the cloud from which the points were selected.
[[nodiscard]] bool needs_dense(double dense_spacing, double spacing);

/// Gives each normal the sign that points outside. Precondition: normals of unit length.
/// Deterministic for any number of threads. Cost: about 8 us per point and core, 1 us per point of
/// `dense`.
[[nodiscard]] CloudOrientation orient_cloud(const OrientationInput& input,
                                            std::span<Eigen::Vector3f> normals);

}  // namespace tactree::builder
