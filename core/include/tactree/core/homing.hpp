#pragma once
// Where the joints are, after power-up: an incremental encoder only knows how far it has come.
// No method moves a motor: until homing is done there is no force.
//
//   kAbsolute   done at once; the model's home_count holds.
//   kGivenPose  the user holds every joint at its home_position and gives the command.
//   kIndex      the user moves about; each joint is done when it passes its index pulse, which is
//               at its home_position. Later pulses are compared: a count that is off by more than
//               kIndexSlack is a lost count.
//   kHardStop   the user moves each joint from stop to stop; it is done when the way agrees with
//               its range, joint_min to joint_max, within kStopShare; the joint's position is
//               then right within half of that.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device_model.hpp"

namespace tactree::core {

/// What one read of the encoders gives.
struct EncoderReading {
  std::int32_t counts[kAxes] = {0, 0, 0};  ///< wrap around at 2^32
  bool valid[kAxes] = {false, false, false};
  bool index[kAxes] = {false, false, false};    ///< an index pulse since the last read
  std::int32_t index_count[kAxes] = {0, 0, 0};  ///< the count at that pulse
};

class Homing {
 public:
  static constexpr std::int32_t kIndexSlack = 4;  ///< counts
  static constexpr float kStopShare = 0.02F;      ///< of the range

  /// Begins anew. Precondition: is_valid(device).
  void begin(const DeviceModel& device);

  /// One tick of valid counts. `device` is that of begin(); its home_count is written where a joint
  /// gets done. `take_pose` is the command of kGivenPose and without effect for the others.
  /// False: an index pulse came at a wrong count. Cost: constant.
  [[nodiscard]] bool update(const EncoderReading& reading, bool take_pose, DeviceModel& device);

  /// Is every joint done?
  [[nodiscard]] bool done() const { return missing_ == 0U; }

 private:
  [[nodiscard]] bool see_index(const EncoderReading& reading, std::uint32_t axis,
                               DeviceModel& device);
  void begin_way(std::int32_t count, std::uint32_t axis);
  void see_way(std::int32_t count, std::uint32_t axis, DeviceModel& device);
  void finish(std::uint32_t axis, std::int32_t home_count, DeviceModel& device);

  // Joints that are not done: bit n is axis n. Before begin(): all.
  std::uint32_t missing_ = (1U << kAxes) - 1U;
  bool moving_ = false;                     // first_ and the way hold
  std::int32_t first_[kAxes] = {0, 0, 0};   // count at begin
  std::int32_t lowest_[kAxes] = {0, 0, 0};  // way since then, counts
  std::int32_t highest_[kAxes] = {0, 0, 0};
};

}  // namespace tactree::core
