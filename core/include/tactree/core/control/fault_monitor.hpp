#pragma once
// Detects faults in the readings of a tick: emergency stop, motors, deadlines, link, enable line,
// supply, stuck encoders. ProbeSensor detects the faults of the encoders' positions.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/control/readings.hpp"
#include "tactree/core/control/state_machine.hpp"
#include "tactree/core/safety/encoder_watch.hpp"
#include "tactree/core/safety/faults.hpp"

namespace tactree::core {

class FaultMonitor {
 public:
  /// The next overrun counts as the first one; overruns() is kept. Precondition: check() accepts
  /// the configuration.
  void configure(const Configuration& configuration);
  /// Applies a configuration of which only the link timeout has changed.
  void set_link_timeout(const Configuration& configuration);

  /// Returns the faults whose cause is present in this tick. `state`: before the tick; `enable`:
  /// setting of the enable line in the previous tick. Cost: constant, about 100 instructions.
  [[nodiscard]] FaultMask update(const Readings& readings, const Configuration& configuration,
                                 State state, bool enable);

  /// Call once per tick while active, at a pose with the full reach. `force`: of the contact, N at
  /// the probe. Returns kEncoderStuck or 0. Cost: constant, about 200 instructions.
  [[nodiscard]] FaultMask update_encoders(const EncoderReading& encoders,
                                          const Configuration& configuration,
                                          const Mat3& effort_per_force, Vec3 force);
  /// Call while not active, and near the end of a joint's range.
  void reset_encoders() { encoders_.reset(); }

  /// Deadlines missed since the start; stays at its maximum.
  [[nodiscard]] std::uint32_t overruns() const { return overruns_; }

 private:
  static constexpr std::uint32_t kForever = 0xFFFFFFFFU;

  [[nodiscard]] FaultMask check_overruns(const Readings& readings, bool motors_on);
  [[nodiscard]] FaultMask check_link(const Readings& readings, bool required);
  [[nodiscard]] FaultMask check_enable(const Readings& readings, State state, bool enable);

  EncoderWatch encoders_{};
  std::uint32_t overruns_ = 0;
  std::uint32_t ticks_since_overrun_ = 0;
  std::uint32_t ticks_since_link_ = 0;
  std::uint32_t ticks_of_mismatch_ = 0;
  std::uint32_t link_timeout_ticks_ = 0;
  std::uint32_t enable_timeout_ticks_ = kForever;  // before configure(): no timeout
};

}  // namespace tactree::core
