// Homing by a given pose, by index pulses or by hard stops.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/device/homing.hpp"

namespace tactree::core {
namespace {

/// a - b with wrap-around.
std::int32_t difference(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}

std::int32_t sum(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

}  // namespace

void Homing::begin(const DeviceModel& device) {
  const std::uint32_t all = (1U << axes_of(device.kind)) - 1U;
  missing_ = device.homing == HomingMethod::kAbsolute ? 0U : all;
  moving_ = false;
}

bool Homing::update(const EncoderReading& reading, bool take_pose, DeviceModel& device) {
  const std::uint32_t axes = axes_of(device.kind);
  bool plausible = true;
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    if (device.homing == HomingMethod::kGivenPose && take_pose) {
      finish(i, reading.counts[i], device);
    } else if (device.homing == HomingMethod::kIndex && reading.index[i]) {
      plausible = see_index(reading, i, device) && plausible;
    } else if (device.homing == HomingMethod::kHardStop) {
      record_travel(reading.counts[i], i, device);
    }
  }
  moving_ = true;
  return plausible;
}

void Homing::finish(std::uint32_t axis, std::int32_t home_count, DeviceModel& device) {
  device.home_count[axis] = home_count;
  missing_ &= ~(1U << axis);
}

bool Homing::see_index(const EncoderReading& reading, std::uint32_t axis, DeviceModel& device) {
  if ((missing_ & (1U << axis)) != 0U) {
    finish(axis, reading.index_count[axis], device);
    return true;
  }
  const std::int32_t off = difference(reading.index_count[axis], device.home_count[axis]);
  return off >= -kIndexSlack && off <= kIndexSlack;
}

void Homing::begin_travel(std::int32_t count, std::uint32_t axis) {
  first_[axis] = count;
  lowest_[axis] = 0;
  highest_[axis] = 0;
}

// The centre of the travel is the centre of the joint's range. Once a joint is homed, further
// contact with a stop does not change its home_count.
void Homing::record_travel(std::int32_t count, std::uint32_t axis, DeviceModel& device) {
  if ((missing_ & (1U << axis)) == 0U) {
    return;
  }
  if (!moving_) {
    begin_travel(count, axis);
  }
  const std::int32_t travel = difference(count, first_[axis]);
  // at most: kAxes per Controller::step together routes
  lowest_[axis] = travel < lowest_[axis] ? travel : lowest_[axis];
  highest_[axis] = travel > highest_[axis] ? travel : highest_[axis];

  const float per_unit = counts_per_unit(device, axis);
  const float range = absolute(per_unit) * (device.joint_max[axis] - device.joint_min[axis]);
  const float travelled = static_cast<float>(highest_[axis]) - static_cast<float>(lowest_[axis]);
  if (!(travelled >= (1.0F - kStopShare) * range)) {
    return;
  }
  // Below 4e9, half of the travel fits into an int32.
  if (!(travelled <= (1.0F + kStopShare) * range && travelled < 4e9F)) {
    begin_travel(count, axis);  // longer than the range: counts were lost
    return;
  }
  const float middle = 0.5F * (device.joint_min[axis] + device.joint_max[axis]);
  const float from_middle = per_unit * (device.home_position[axis] - middle);
  const std::int32_t middle_travel = lowest_[axis] + static_cast<std::int32_t>(0.5F * travelled);
  finish(axis, sum(sum(first_[axis], middle_travel), static_cast<std::int32_t>(from_middle)),
         device);
}

}  // namespace tactree::core
