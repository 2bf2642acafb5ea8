// memory: RAM

#include "tactree/core/homing.hpp"

namespace tactree::core {
namespace {

/// a - b as counters do it.
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
      see_way(reading.counts[i], i, device);
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

void Homing::begin_way(std::int32_t count, std::uint32_t axis) {
  first_[axis] = count;
  lowest_[axis] = 0;
  highest_[axis] = 0;
}

// The middle of the way is the middle of the range. It stays so once the joint is done: another
// touch of a stop cannot move it.
void Homing::see_way(std::int32_t count, std::uint32_t axis, DeviceModel& device) {
  if ((missing_ & (1U << axis)) == 0U) {
    return;
  }
  if (!moving_) {
    begin_way(count, axis);
  }
  const std::int32_t way = difference(count, first_[axis]);
  // at most: kAxes per Controller::step together ways
  lowest_[axis] = way < lowest_[axis] ? way : lowest_[axis];
  highest_[axis] = way > highest_[axis] ? way : highest_[axis];

  const float per_unit = counts_per_unit(device, axis);
  const float range = absolute(per_unit) * (device.joint_max[axis] - device.joint_min[axis]);
  const float gone = static_cast<float>(highest_[axis]) - static_cast<float>(lowest_[axis]);
  if (!(gone >= (1.0F - kStopShare) * range)) {
    return;
  }
  if (!(gone <= (1.0F + kStopShare) * range && gone < 4e9F)) {
    begin_way(count, axis);  // further than the joint can go: counts were lost
    return;
  }
  const float middle = 0.5F * (device.joint_min[axis] + device.joint_max[axis]);
  const float from_middle = per_unit * (device.home_position[axis] - middle);
  const std::int32_t way_middle = lowest_[axis] + static_cast<std::int32_t>(0.5F * gone);
  finish(axis, sum(sum(first_[axis], way_middle), static_cast<std::int32_t>(from_middle)), device);
}

}  // namespace tactree::core
