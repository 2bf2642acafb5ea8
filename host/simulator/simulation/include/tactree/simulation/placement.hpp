#pragma once
// Placement of a model in front of a device.

#include <Eigen/Geometry>

#include "tactree/core/device/device_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::simulation {

/// Origin of the scene in the device's frame that places the centre of the model, at `pose` in the
/// scene, at the device's origin. For devices of one or two axes, with a small workspace: the
/// centre of its top.
[[nodiscard]] core::Vec3 middle_at_origin(const core::BlobHeader& model,
                                          const Eigen::Isometry3d& pose, core::DeviceKind kind);

}  // namespace tactree::simulation
