#pragma once
// Where a model stands in front of a device.

#include <Eigen/Geometry>

#include "tactree/core/blob.hpp"
#include "tactree/core/device_model.hpp"

namespace tactree::simulation {

/// The origin of the scene in the device's frame that brings the model's middle, at `pose` in the
/// scene, to the device's origin. Devices of one or two axes do not reach far: they get the middle
/// of its top.
[[nodiscard]] core::Vec3 middle_at_origin(const core::BlobHeader& model,
                                          const Eigen::Isometry3d& pose, core::DeviceKind kind);

}  // namespace tactree::simulation
