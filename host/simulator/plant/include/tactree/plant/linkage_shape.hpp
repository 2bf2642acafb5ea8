#pragma once
// Links of a device as lines in space, for pictures.

#include <Eigen/Core>
#include <vector>

#include "tactree/core/device/device_model.hpp"

namespace tactree::plant {

/// From a fixed joint through the moving joints to the tip, device frame, m.
using Polyline = std::vector<Eigen::Vector3d>;

/// Links of a device at the positions `joints` with its tip at `tip_m`, as of Linkage::pose(). Arm:
/// one line; delta or five-bar: one per leg; paddle: its lever; linear axes: the rails through the
/// tip within the joints' ranges, at most kDrawnRail_m to either side.
inline constexpr double kDrawnRail_m = 0.15;
[[nodiscard]] std::vector<Polyline> linkage_shape(const core::DeviceModel& model,
                                                  const Eigen::Vector3d& joints,
                                                  const Eigen::Vector3d& tip_m);

}  // namespace tactree::plant
