#pragma once
// Computes the probe from encoder counts: homing, kinematics, velocity, and the detection of
// invalid counts and impossible positions.
//
// Interrupt safe: no shared state.

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/device/homing.hpp"
#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/device/velocity.hpp"
#include "tactree/core/safety/faults.hpp"

namespace tactree::core {

class ProbeSensor {
 public:
  /// Begins homing. Precondition: check() accepts the configuration.
  void configure(const Configuration& configuration);

  struct Sensed {
    FaultMask faults = 0;
    bool jumped = false;  ///< the position does not follow from the last one: contacts end
  };
  /// Processes one tick. `take_pose`: see Homing::update(). Homing writes
  /// configuration.device.home_count. Cost: constant; locate() and about 200 instructions.
  [[nodiscard]] Sensed update(const EncoderReading& encoders, bool take_pose,
                              Configuration& configuration);

  /// Discards the motion: the next position does not follow from the last one.
  void forget_motion();
  /// Restarts homing, because the counts cannot be trusted.
  void lose_position(const DeviceModel& device) { homing_.begin(device); }

  [[nodiscard]] bool homed() const { return homing_.done(); }
  /// True if pose(), probe() and velocity() are those of this tick.
  [[nodiscard]] bool located() const { return located_; }
  [[nodiscard]] const DevicePose& pose() const { return pose_; }
  [[nodiscard]] Vec3 probe() const { return probe_; }        ///< m, scene's frame
  [[nodiscard]] Vec3 velocity() const { return velocity_; }  ///< m/s

 private:
  Homing homing_{};
  DevicePose pose_{};
  Vec3 probe_{};
  Vec3 velocity_{};
  VelocityEstimator joint_velocity_{};
  bool located_ = false;
};

}  // namespace tactree::core
