#pragma once
// Rotations from the axes of a scan to those of its model.

#include <Eigen/Core>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Turns the axis `up` of the source to z, and the other two, in cyclic order, to x and y: of y up,
/// z faces the user.
[[nodiscard]] Eigen::Matrix3d turn_up(UpAxis up);

/// About z, counterclockwise seen from above; exact for multiples of 90 degrees.
[[nodiscard]] Eigen::Matrix3d turn_about_z(double degrees);

}  // namespace tactree::builder
