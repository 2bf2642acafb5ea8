#pragma once
// Placement of a model in front of a device.

#include <Eigen/Geometry>

#include "tactree/core/device/device_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::simulation {

/// Origin of the scene in the device frame for which the centre of the model, at `pose` in the
/// scene, is at the device's origin. For a device of one or two axes, whose workspace is small, the
/// centre of the model's top is placed there instead.
[[nodiscard]] core::Vec3 middle_at_origin(const core::BlobHeader& model,
                                          const Eigen::Isometry3d& pose, core::DeviceKind kind);

}  // namespace tactree::simulation
