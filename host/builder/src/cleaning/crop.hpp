#pragma once
// The box to which the user limits the model.

#include <Eigen/Core>
#include <array>

#include "geometry/cloud.hpp"

namespace tactree::builder {

struct Crop {
  Box box;  ///< in the axes of the source, with the unit and origin of the model; empty: none
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from these axes to those of the model

  [[nodiscard]] bool is_set() const { return !box.isEmpty(); }
  /// `position` is in the model frame.
  [[nodiscard]] bool contains(const Eigen::Vector3d& position) const {
    return box.contains(turn.transpose() * position);
  }
};

/// Bounds of the part of a triangle that is in `crop`, in the model frame; empty if there is none.
[[nodiscard]] Box cropped_bounds(const std::array<Eigen::Vector3d, 3>& triangle, const Crop& crop);

}  // namespace tactree::builder
