// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/probe_sensor.hpp"

namespace tactree::core {
namespace {

/// The step of one count, for each joint.
Vec3 quantum_of(const DeviceModel& device) {
  float quantum[kAxes] = {0.0F, 0.0F, 0.0F};
  const std::uint32_t axes = axes_of(device.kind);
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    quantum[i] = 1.0F / absolute(counts_per_unit(device, i));
  }
  return {quantum[0], quantum[1], quantum[2]};
}

bool all_valid(const EncoderReading& encoders, const DeviceModel& device) {
  const std::uint32_t axes = axes_of(device.kind);
  bool valid = true;
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    valid = valid && encoders.valid[i];
  }
  return valid;
}

}  // namespace

void ProbeSensor::configure(const Configuration& configuration) {
  joint_velocity_.configure(1.0F / configuration.rate_hz, quantum_of(configuration.device),
                            configuration.velocity_cutoff_hz);
  homing_.begin(configuration.device);
  forget_motion();
}

void ProbeSensor::forget_motion() {
  located_ = false;
  joint_velocity_.reset();
  velocity_ = {};
}

ProbeSensor::Sensed ProbeSensor::update(const EncoderReading& encoders, bool take_pose,
                                        Configuration& configuration) {
  // A counter that was invalid for one tick has lost its position.
  const bool trusted = all_valid(encoders, configuration.device) &&
                       homing_.update(encoders, take_pose, configuration.device);
  if (!trusted) {
    homing_.begin(configuration.device);
  }
  if (!trusted || !homing_.done()) {
    forget_motion();
    return {trusted ? 0U : fault_bit(Fault::kEncoderInvalid), true};
  }
  pose_ = locate(configuration.device, encoders.counts);
  if (!pose_.valid) {
    forget_motion();
    return {fault_bit(Fault::kEncoderInvalid), true};
  }
  const Vec3 probe = pose_.probe - configuration.model_origin_m;
  const float furthest = configuration.supervision.speed_max_m_s / configuration.rate_hz;
  const bool jumped = located_ && !(length_squared(probe - probe_) <= furthest * furthest);
  const bool begins = jumped || !located_;
  if (begins) {
    joint_velocity_.reset();
  }
  probe_ = probe;
  located_ = true;
  // Estimated in the joints, where a count is one step; at the probe the steps of all joints mix.
  velocity_ = transposed_times(pose_.effort_per_force, joint_velocity_.update(pose_.joints));
  if (!jumped) {
    return {0U, begins};
  }
  homing_.begin(configuration.device);
  return {fault_bit(Fault::kEncoderJump), begins};
}

}  // namespace tactree::core
