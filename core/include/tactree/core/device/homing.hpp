#pragma once
// Homing of the joints after power-up, because an incremental encoder measures displacement only.
// No method drives a motor, and the force is zero until homing is done.
//
//   kAbsolute   done at once; uses the model's home_count.
//   kGivenPose  the user holds every joint at its home_position and sends the command.
//   kIndex      the user moves the device; a joint is homed at its index pulse, which is at its
//               home_position. Later pulses are checked: a deviation above kIndexSlack means that
//               counts were lost.
//   kHardStop   the user moves each joint from stop to stop; a joint is homed when its travel is
//               equal to its range, joint_min to joint_max, within kStopShare. Position error: at
//               most half of kStopShare.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device/device_model.hpp"

namespace tactree::core {

/// One reading of the encoders.
struct EncoderReading {
  std::int32_t counts[kAxes] = {0, 0, 0};  ///< wraps around at 2^32
  bool valid[kAxes] = {false, false, false};
  bool index[kAxes] = {false, false, false};    ///< an index pulse occurred since the last reading
  std::int32_t index_count[kAxes] = {0, 0, 0};  ///< count at that pulse
};

class Homing {
 public:
  /// Counts: one line of the encoder, the width of an index pulse. Less would report a fault when
  /// the pulse is passed from the other side; more would tolerate lost counts, each 0.03 mm at the
  /// probe of the premium preset.
  static constexpr std::int32_t kIndexSlack = 4;
  /// Tolerance of the travel, relative to the range. If it is less than that of the stops and of
  /// joint_min and joint_max, a joint is never homed. A joint of the pantograph preset travels 1560
  /// counts: 31 lost counts are tolerated, an error of at most 1.2 degrees.
  static constexpr float kStopShare = 0.02F;

  /// Restarts homing. Precondition: is_valid(device). Cost: constant.
  void begin(const DeviceModel& device);

  /// Call once per tick with valid counts. `device`: as passed to begin(); receives the home_count
  /// of each homed joint. `take_pose`: command of kGivenPose; ignored by the other methods. Returns
  /// false if an index pulse occurred at a wrong count. Cost: constant.
  [[nodiscard]] bool update(const EncoderReading& reading, bool take_pose, DeviceModel& device);

  /// True if every joint is homed.
  [[nodiscard]] bool done() const { return missing_ == 0U; }

 private:
  [[nodiscard]] bool see_index(const EncoderReading& reading, std::uint32_t axis,
                               DeviceModel& device);
  void begin_travel(std::int32_t count, std::uint32_t axis);
  void record_travel(std::int32_t count, std::uint32_t axis, DeviceModel& device);
  void finish(std::uint32_t axis, std::int32_t home_count, DeviceModel& device);

  // Bit n is set while joint n is not homed. All bits are set before begin().
  std::uint32_t missing_ = (1U << kAxes) - 1U;
  bool moving_ = false;                     // first_ and the travel are valid
  std::int32_t first_[kAxes] = {0, 0, 0};   // count at the start of the travel
  std::int32_t lowest_[kAxes] = {0, 0, 0};  // extremes of the travel since then, counts
  std::int32_t highest_[kAxes] = {0, 0, 0};
};

}  // namespace tactree::core
