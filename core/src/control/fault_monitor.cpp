// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/fault_monitor.hpp"

namespace tactree::core {
namespace {

// Ticks. A single overrun keeps the last force for one period longer, and is only counted. Two
// within this window are a fault: more than 1 % of the ticks are late, so the loop is too slow.
constexpr std::uint32_t kOverrunWindow = 100;

constexpr std::uint32_t add_saturating(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kMax = 0xFFFFFFFFU;
  return b > kMax - a ? kMax : a + b;
}

FaultMask check_supply(const Readings& readings, const Configuration& configuration) {
  const bool good = readings.supply_V >= configuration.supervision.supply_min_V &&
                    readings.supply_V <= configuration.supervision.supply_max_V;
  return configuration.supervision.supply_monitored && !good ? fault_bit(Fault::kSupply) : 0U;
}

}  // namespace

void FaultMonitor::configure(const Configuration& configuration) {
  set_link_timeout(configuration);
  enable_timeout_ticks_ = static_cast<std::uint32_t>(configuration.supervision.enable_timeout_s *
                                                     configuration.rate_hz);
  ticks_since_overrun_ = kForever;
  encoders_.configure(
      static_cast<std::uint32_t>(configuration.supervision.stuck_s * configuration.rate_hz));
}

void FaultMonitor::set_link_timeout(const Configuration& configuration) {
  link_timeout_ticks_ =
      static_cast<std::uint32_t>(configuration.link.timeout_s * configuration.rate_hz);
}

FaultMask FaultMonitor::update(const Readings& readings, const Configuration& configuration,
                               State state, bool enable) {
  const bool motors_on = state == State::kArmed || state == State::kActive;
  FaultMask faults = check_overruns(readings, motors_on) |
                     check_link(readings, configuration.link.required && motors_on) |
                     check_enable(readings, state, enable);
  faults |= motors_on ? check_supply(readings, configuration) : 0U;
  faults |= readings.emergency_stop ? fault_bit(Fault::kEmergencyStop) : 0U;
  faults |= readings.motors_ok ? 0U : fault_bit(Fault::kMotorFault);
  return faults;
}

// The hand yields in the direction of the force. This moves an axis by the force along the gradient
// of its joint, which is not the effort of its motor: that may hold what the other axes carry. Row
// i of force_per_effort() is the gradient of joint i.
FaultMask FaultMonitor::update_encoders(const EncoderReading& encoders,
                                        const Configuration& configuration,
                                        const Mat3& effort_per_force, Vec3 force) {
  const Mat3 gradients = force_per_effort(effort_per_force);
  float share[kAxes];
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    const Vec3 gradient = gradients.row[i];
    const float most = length_squared(gradient) * configuration.motors.effort_max[i];
    share[i] = most > 0.0F ? dot(gradient, force) / most : 0.0F;
  }
  const bool moves = encoders_.update(encoders.counts, share, axes_of(configuration.device.kind));
  return moves ? 0U : fault_bit(Fault::kEncoderStuck);
}

FaultMask FaultMonitor::check_overruns(const Readings& readings, bool motors_on) {
  ticks_since_overrun_ = add_saturating(ticks_since_overrun_, 1);
  if (readings.overruns == 0U || (readings.storage_busy && !motors_on)) {
    return 0U;
  }
  const bool again = readings.overruns > 1U || ticks_since_overrun_ <= kOverrunWindow;
  overruns_ = add_saturating(overruns_, readings.overruns);
  ticks_since_overrun_ = 0;
  return again ? fault_bit(Fault::kDeadlineMissed) : 0U;
}

FaultMask FaultMonitor::check_link(const Readings& readings, bool required) {
  const std::uint32_t longer = add_saturating(ticks_since_link_, 1);
  const std::uint32_t age = readings.link_age_ticks;
  ticks_since_link_ = readings.link_alive && age < longer ? age : longer;
  return required && ticks_since_link_ > link_timeout_ticks_ ? fault_bit(Fault::kLinkLost) : 0U;
}

// In the active state a drop-out is a fault immediately, without the timeout: when the power
// returned, the force would return with it, without a ramp.
FaultMask FaultMonitor::check_enable(const Readings& readings, State state, bool enable) {
  const bool agrees = readings.enable_read_back == enable;
  ticks_of_mismatch_ = agrees ? 0U : add_saturating(ticks_of_mismatch_, 1);
  const bool dropped = state == State::kActive && !readings.enable_read_back;
  const bool late = ticks_of_mismatch_ > enable_timeout_ticks_;
  return dropped || late ? fault_bit(Fault::kEnableMismatch) : 0U;
}

}  // namespace tactree::core
