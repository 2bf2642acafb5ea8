#pragma once
// Workspace: the positions that the probe of a device reaches.

#include <Eigen/Core>
#include <optional>

#include "tactree/core/device/device_model.hpp"

namespace tactree::simulation {

/// True if the probe reaches the position (m, device frame) and the device renders its full force
/// there, that is, within the joint ranges less their margins and away from singular poses.
/// Precondition: core::is_valid(device).
[[nodiscard]] bool reaches(const core::DeviceModel& device, const Eigen::Vector3d& place_m);

/// True if the probe reaches 98 points on the faces of a box of `size_m` centred at the device's
/// origin. Also true for a device of one or two axes, which touches only a section of a model.
/// Precondition: core::is_valid(device).
[[nodiscard]] bool reaches_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m);

inline constexpr double kMaxScale = 1e6;

/// Maximum factor, up to kMaxScale, by which the box of reaches_box() can be scaled so that the
/// probe still reaches it, accurate to 0.1 %. Empty for a device of one or two axes and for an
/// empty box. Precondition: core::is_valid(device).
[[nodiscard]] std::optional<double> largest_scale(const core::DeviceModel& device,
                                                  const Eigen::Vector3d& size_m);

}  // namespace tactree::simulation
