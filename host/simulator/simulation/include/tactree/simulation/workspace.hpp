#pragma once
// Workspace: the positions that the probe of a device reaches.

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "tactree/core/device/device_model.hpp"

namespace tactree::simulation {

/// True if the probe reaches the position (m, device frame) and the device renders its full force
/// there, that is, within the joint ranges less their margins and away from singular poses.
/// Precondition: core::is_valid(device).
[[nodiscard]] bool reaches(const core::DeviceModel& device, const Eigen::Vector3d& place_m);

/// The same for a probe that comes within `distance_m` of the position.
[[nodiscard]] bool comes_near(const core::DeviceModel& device, const Eigen::Vector3d& place_m,
                              double distance_m);

/// True if a session may begin with the hand there: the probe reaches the position, or comes within
/// 5 mm of it if it moves only in a plane or on an arc. Precondition: core::is_valid(device).
[[nodiscard]] bool reaches_start(const core::DeviceModel& device, const Eigen::Vector3d& start_m);

/// True if the probe reaches 98 points on the faces of a box of `size_m` at the device's origin.
/// The origin is the centre of the box; for a device of one or two axes the centre of its top, of
/// which it must reach the edges of the section in the plane of the probe (two axes) or the heights
/// (one axis). Precondition: core::is_valid(device).
[[nodiscard]] bool reaches_box(const core::DeviceModel& device, const Eigen::Vector3d& size_m);
/// The same for a box whose centre and axes are those of `pose` in the device frame. Precondition:
/// also a device of three axes.
[[nodiscard]] bool reaches_box(const core::DeviceModel& device, const Eigen::Isometry3d& pose,
                               const Eigen::Vector3d& size_m);

inline constexpr double kMaxScale = 1e6;

/// Maximum factor, up to kMaxScale, by which the box of reaches_box() can be scaled so that the
/// probe still reaches it, accurate to 0.1 %. Empty for an empty box. Precondition:
/// core::is_valid(device).
[[nodiscard]] std::optional<double> largest_scale(const core::DeviceModel& device,
                                                  const Eigen::Vector3d& size_m);

/// The border of the workspace, for drawings: a grid of positions in the device frame, row by row,
/// whose rows are closed. Empty if the device does not reach its origin.
struct ReachShape {
  int rows = 0;
  int columns = 0;
  std::vector<Eigen::Vector3d> points_m;
};

/// Of a device of three axes, a surface whose rows go around z, from -z to +z; of two, an area as
/// rows of its middle and its border; of one, the way of the probe, there and back. A border is the
/// first position that is not reached, to a millimetre; a device without limits is drawn up to 2 m,
/// or one turn. Precondition: core::is_valid(device). Cost: some tenths of a second.
[[nodiscard]] ReachShape reach_shape(const core::DeviceModel& device);

}  // namespace tactree::simulation
