#pragma once
// A hand that guides the probe of a device, whose encoders are those of a FakeChip, and a surface
// for it to touch.

#include <cmath>

#include "fake_chip.hpp"
#include "tactree/core/device/kinematics.hpp"
#include "tactree/evaluation/shapes.hpp"

namespace tactree::test {

/// The sheet whose highest points are 3 mm below the home of the probe, which is the origin.
inline evaluation::Shape sheet_below_hand() {
  evaluation::Shape sheet = evaluation::cos_sheet();
  for (Eigen::Vector3d& point : sheet.model().positions) {
    point.z() -= 8e-3;
  }
  sheet.seal();
  return sheet;
}
inline constexpr core::Vec3 kOnSheetBelowHand = {0.0F, 0.0F, -4e-3F};  ///< 1 mm deep

class FakeHand {
 public:
  /// The device is at its home.
  explicit FakeHand(const core::DeviceModel& device) : device_(device) {
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      counts_[axis] = device.home_count[axis];
    }
    joints_ = core::joints_of(device, counts_);
  }

  /// Moves in a straight line, 0.1 mm before each call of `tick`.
  template <class Tick>
  void move(FakeChip& chip, core::Vec3 to, Tick tick) {
    const core::Vec3 from = core::locate(device_, counts_).probe;
    const int steps = 1 + static_cast<int>(core::length(to - from) / 1e-4F);
    for (int i = 1; i <= steps; ++i) {
      reach(chip, from + (static_cast<float>(i) / static_cast<float>(steps)) * (to - from));
      tick();
    }
  }

  [[nodiscard]] core::DevicePose pose() const { return core::locate(device_, counts_); }

 private:
  void reach(FakeChip& chip, core::Vec3 target) {
    for (int i = 0; i < 3; ++i) {  // Newton's method
      const core::DevicePose pose = core::locate_joints(device_, joints_);
      joints_ += core::force_per_effort(pose.effort_per_force) * (target - pose.probe);
    }
    const float joints[] = {joints_.x, joints_.y, joints_.z};
    std::int32_t turned[core::kAxes];
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      const float angle = joints[axis] - device_.home_position[axis];
      const auto counts =
          device_.home_count[axis] +
          static_cast<std::int32_t>(std::lround(angle * core::counts_per_unit(device_, axis)));
      turned[axis] = counts - counts_[axis];
      counts_[axis] = counts;
    }
    chip.turn(turned[0], turned[1], turned[2]);
  }

  core::DeviceModel device_;
  core::Vec3 joints_{};
  std::int32_t counts_[core::kAxes];
};

}  // namespace tactree::test
