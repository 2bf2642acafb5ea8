#pragma once
// The places that the probe of a device reaches.

#include <Eigen/Core>
#include <optional>

#include "tactree/core/device/device_model.hpp"

namespace tactree::simulation {

/// True if the probe reaches the place (m, device frame) and the device displays its full force
/// there: within the joints' ranges less their margins, away from singular poses.
/// Precondition: core::is_valid(device).
[[nodiscard]] bool reaches(const core::DeviceModel& device, const Eigen::Vector3d& place_m);

/// True if the probe reaches 98 points spread over the faces of a box of `size_m` with its middle
/// at the device's origin. Also true for a device of one or two axes, which touches a section of a
/// model only. Precondition: core::is_valid(device).
[[nodiscard]] bool reaches_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m);

/// Largest factor, at most kLargestScale, by which such a box can be scaled and still be reached.
/// Accuracy: 0.1 %. Empty for a device of one or two axes, and for an empty box.
/// Precondition: core::is_valid(device).
inline constexpr double kLargestScale = 1e6;
[[nodiscard]] std::optional<double> largest_scale(const core::DeviceModel& device,
                                                  const Eigen::Vector3d& size_m);

}  // namespace tactree::simulation
