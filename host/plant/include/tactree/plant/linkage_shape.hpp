#pragma once
// A device's links as lines in space, for pictures.

#include <Eigen/Core>
#include <vector>

#include "tactree/core/device_model.hpp"

namespace tactree::plant {

/// From a fixed joint over the moving ones towards the tip, device frame, m.
using Polyline = std::vector<Eigen::Vector3d>;

/// The links of a device whose joints are at `joints` and whose tip is at `tip_m`, as
/// Linkage::pose() says: of an arm one line, of a delta or five-bar one a leg, of a paddle its
/// lever, of linear axes the ways through the tip, cut to the joints' ranges and at most
/// kDrawnWay_m to either side.
inline constexpr double kDrawnWay_m = 0.15;
[[nodiscard]] std::vector<Polyline> linkage_shape(const core::DeviceModel& model,
                                                  const Eigen::Vector3d& joints,
                                                  const Eigen::Vector3d& tip_m);

}  // namespace tactree::plant
