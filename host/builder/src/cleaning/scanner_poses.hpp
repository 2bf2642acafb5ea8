#pragma once
// Whether a scanner can have recorded a cloud from the position that its file states.

#include <Eigen/Core>
#include <span>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// How the points appear from a position, on a grid of directions.
struct Appearance {
  double hidden = 0.0;      ///< share of the points that are behind others
  double unevenness = 1.0;  ///< of the points per solid angle: 9th over 1st decile
  double range = 0.0;       ///< of the middle of the points, in diagonals of their box
};
/// Finite positions. Cost: about 0.1 us per point, of up to 200 000.
[[nodiscard]] Appearance appearance_from(const Eigen::Vector3d& viewpoint,
                                         std::span<const Eigen::Vector3d> positions);

/// Sets the poses of a scan that its points contradict to NaN, with a warning, and those that may
/// be a default and do not look like the position of a scanner. Adds the rest to
/// report.orientation.scanners.
void check_poses(Scan& scan, BuildReport& report);

}  // namespace tactree::builder
