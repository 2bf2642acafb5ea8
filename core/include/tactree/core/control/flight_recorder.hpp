#pragma once
// Ring buffer of the last ticks. A fault stops the recording after kAfterFault further ticks, which
// preserves the ticks before the fault; clearing the fault resumes the recording.
//
// Interrupt safety: no shared state; read it in the context that calls add().

#include <cstdint>

#include "tactree/core/contact/renderer.hpp"
#include "tactree/core/control/state_machine.hpp"
#include "tactree/core/math/vec3.hpp"
#include "tactree/core/safety/faults.hpp"

namespace tactree::core {

/// One tick, rounded: 18 bytes.
struct FlightRecord {
  // The links of the presets are at most 0.45 m long in all, and their forces at most 8.5 N.
  static constexpr float kMetre = 50000.0F;  ///< units of 20 um; clamped to +-0.65 m
  static constexpr float kNewton = 1000.0F;  ///< units of 1 mN; clamped to +-32 N
  static constexpr float kDepth = 20000.0F;  ///< units of 50 um; clamped to +-6.3 mm

  std::int16_t probe[3] = {0, 0, 0};
  std::int16_t force[3] = {0, 0, 0};
  std::int8_t proxy[3] = {0, 0, 0};  ///< relative to the probe, in units of kDepth
  std::uint8_t state = 0;            ///< bits 0-2: State; bit 3: in contact; bit 4: slipping
  std::uint8_t load = 0;  ///< duration of the tick, period / 128; 255: two periods or more

  [[nodiscard]] State state_of() const { return static_cast<State>(state & 7U); }
  [[nodiscard]] bool in_contact() const { return (state & 8U) != 0U; }
  [[nodiscard]] bool slipping() const { return (state & 16U) != 0U; }
};
static_assert(sizeof(FlightRecord) == 18);

/// The tick in which the first fault since the last clear was latched.
struct FaultSnapshot {
  FaultMask faults = 0;  ///< all faults latched in that tick; 0: none
  std::uint32_t tick = 0;
  Vec3 probe{};     ///< m
  Vec3 proxy{};     ///< m
  Vec3 velocity{};  ///< m/s
  Vec3 force{};     ///< N, of the preceding tick
};

class FlightRecorder {
 public:
  /// 0.5 s at 1 kHz, 0.13 s at 4 kHz; 9 KiB of RAM. A power of two: the index wraps without a
  /// division.
  static constexpr std::uint32_t kTicks = 512;
  /// Ticks recorded after a fault was latched: how the probe moves once the force is zero. They
  /// replace the oldest ticks before the fault, of which 480 remain.
  static constexpr std::uint32_t kAfterFault = 32;

  /// State of a tick.
  struct Moment {
    State state = State::kBoot;
    FaultMask faults = 0;
    std::uint32_t tick = 0;
    Vec3 probe{};
    Vec3 velocity{};
    Vec3 force{};
    const Rendering& rendering;
    float load = 0.0F;  ///< duration of the last tick / period, >= 0
  };

  /// Cost: constant.
  void add(const Moment& moment);

  /// Number of records: 0 .. kTicks.
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Record by age; 0: newest. Precondition: age < count().
  [[nodiscard]] const FlightRecord& record(std::uint32_t age) const {
    return records_[(next_ + kTicks - 1U - age) % kTicks];
  }
  /// Tick of the newest record.
  [[nodiscard]] std::uint32_t last_tick() const { return last_tick_; }
  [[nodiscard]] const FaultSnapshot& snapshot() const { return snapshot_; }

 private:
  FlightRecord records_[kTicks]{};
  std::uint32_t next_ = 0;
  std::uint32_t count_ = 0;
  std::uint32_t last_tick_ = 0;
  std::uint32_t left_ = 0;  // ticks still to be recorded after a fault
  Vec3 last_force_{};
  FaultSnapshot snapshot_{};
};

}  // namespace tactree::core
