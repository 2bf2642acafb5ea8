#include "tactree/simulation/placement.hpp"

namespace tactree::simulation {

core::Vec3 middle_at_origin(const core::BlobHeader& model, const Eigen::Isometry3d& pose,
                            core::DeviceKind kind) {
  const Eigen::Vector3f low(model.bounds_min_m);
  const Eigen::Vector3f high(model.bounds_max_m);
  Eigen::Vector3f held = 0.5F * (low + high);
  if (core::axes_of(kind) != core::kAxes) {
    held.z() = high.z();
  }
  held = pose.cast<float>() * held;
  return {-held.x(), -held.y(), -held.z()};
}

}  // namespace tactree::simulation
