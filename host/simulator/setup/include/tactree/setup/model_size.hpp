#pragma once
// Compares the size of a model with the workspace of a device.

#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "tactree/core/device/device_model.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/simulation/placement.hpp"

namespace tactree::setup {

/// A warning with a hint if the device cannot reach the model's bounding box at the device's
/// origin: see simulation::reaches_box(). For a device of one or two axes it also states whether
/// the probe meets the surface at all. Cost: some tenths of a second.
[[nodiscard]] std::optional<std::string> oversize_warning(const core::BlobView& model,
                                                          const std::string& device_name,
                                                          const core::DeviceModel& device);

/// A warning with a hint if the device cannot reach all faces of the model's bounding box where
/// `pose` (device frame) places it. For a device of two axes: not all of the surface in the plane
/// of its probe. For one axis: none on its arc.
[[nodiscard]] std::optional<std::string> misplaced_warning(const core::BlobView& model,
                                                           const std::string& device_name,
                                                           const core::DeviceModel& device,
                                                           const Eigen::Isometry3d& pose);

/// The placement at which the device reaches the model, turned as in `now`: in the largest size
/// with room for the probe, or in the present one if that is smaller, with its centre at the
/// device's origin, or the centre of its top for a device of one or two axes. `model` is the model
/// at scale 1. Empty as for fitting_scale().
[[nodiscard]] std::optional<simulation::Placement> fitted_placement(
    const core::DeviceModel& device, const core::BlobHeader& model,
    const simulation::Placement& now);

/// Factor that scales a model of this size to the workspace of a device, with room for the probe
/// around it. Empty if the origin of the device is not inside its workspace.
[[nodiscard]] std::optional<double> fitting_scale(const core::DeviceModel& device,
                                                  const Eigen::Vector3d& size_m);
[[nodiscard]] Eigen::Vector3d size_of(const core::BlobHeader& model);

/// The advice of the builder on models that no device reaches or that are too small to feel, with
/// the name of the file. Empty for other models.
[[nodiscard]] std::optional<std::string> size_warning(const std::string& file,
                                                      const core::BlobHeader& model);

}  // namespace tactree::setup
