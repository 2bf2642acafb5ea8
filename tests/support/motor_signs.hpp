#pragma once
// Force at the probe of the efforts that motors are told, in double precision, for any combination
// of wrong signs.

#include <Eigen/Dense>
#include <algorithm>

#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::test {

/// N. Bit i of `wrong`: motor i turns the wrong way.
inline double probe_force(const core::DevicePose& pose, const core::MotorCommand& command,
                          std::uint32_t wrong) {
  Eigen::Matrix3d rows;
  Eigen::Vector3d efforts;
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    const core::Vec3 row = pose.effort_per_force.row[axis];
    rows.row(axis) << static_cast<double>(row.x), static_cast<double>(row.y),
        static_cast<double>(row.z);
    efforts[axis] =
        ((wrong >> axis & 1U) != 0U ? -1.0 : 1.0) * static_cast<double>(command.effort(axis));
  }
  return rows.completeOrthogonalDecomposition().solve(efforts).norm();
}

/// N, with the worst combination of signs.
inline double largest_probe_force(const core::DevicePose& pose, const core::MotorCommand& command) {
  double largest = 0.0;
  for (std::uint32_t wrong = 0; wrong < 1U << core::kAxes; ++wrong) {
    largest = std::max(largest, probe_force(pose, command, wrong));
  }
  return largest;
}

}  // namespace tactree::test
