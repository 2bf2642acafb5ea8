#pragma once
// Conversion between the controller's float32 vectors and the double precision vectors of
// simulation and evaluation.

#include <Eigen/Core>

#include "tactree/core/math/vec3.hpp"

namespace tactree::plant {

inline core::Vec3 narrow(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

inline Eigen::Vector3d widen(core::Vec3 v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

}  // namespace tactree::plant
