#pragma once
// Links of a device as polylines in space, for pictures.

#include <Eigen/Core>
#include <vector>

#include "tactree/core/device/device_model.hpp"

namespace tactree::plant {

/// From a fixed joint through the moving joints to the tip, device frame, m.
using Polyline = std::vector<Eigen::Vector3d>;

/// Maximum length of a rail on either side of the tip. The joint ranges may be much longer.
inline constexpr double kDrawnRail_m = 0.15;

/// Links of a device at the joint positions `joints` with the tip at `tip_m`, the position that
/// Linkage::pose() returns for them. An arm is one line, a delta or five-bar device one line per
/// leg, and a paddle is its lever. Linear axes are rails through the tip within the joint ranges.
[[nodiscard]] std::vector<Polyline> linkage_shape(const core::DeviceModel& model,
                                                  const Eigen::Vector3d& joints,
                                                  const Eigen::Vector3d& tip_m);

}  // namespace tactree::plant
