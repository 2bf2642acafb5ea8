#pragma once
// Encoders of a simulated cartesian device: counts per metre, quantisation, latency, faults.
// Loop and memory annotations: docs/BOUND.md.

#include <cmath>
#include <cstdint>

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/sim/delay_line.hpp"

namespace tactree::hal::sim {

/// Fault of one encoder axis.
enum class EncoderFault : std::uint8_t {
  kNone = 0,
  kStuck,         ///< the count does not change
  kDisconnected,  ///< reported as not valid
};

struct EncoderParameters {
  double counts_per_m = 1.0 / 30e-6;  ///< > 0; 0.03 mm per count, as in the PHANTOM Premium
  std::uint32_t latency_ticks = 0;    ///< 0 .. kMaxLatencyTicks
  std::uint32_t start_count = 0;      ///< count at 0 m; a value near 2^31 tests the overflow
};

class SimEncoderBank {
 public:
  explicit SimEncoderBank(const EncoderParameters& parameters)
      : parameters_(parameters), line_(parameters.latency_ticks, core::EncoderReading{}) {}

  /// Samples the positions of the axes, m. Call once per tick.
  void sample(const double (&position_m)[core::kAxes]) {
    core::EncoderReading reading;
    for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
      const double counts = std::floor(position_m[i] * parameters_.counts_per_m);
      const auto moving = static_cast<std::uint32_t>(static_cast<std::int64_t>(counts)) +
                          parameters_.start_count + offset_[i];
      held_[i] = fault_[i] == EncoderFault::kStuck ? held_[i] : moving;
      reading.counts[i] = static_cast<std::int32_t>(held_[i]);
      reading.valid[i] = fault_[i] != EncoderFault::kDisconnected;
    }
    line_.push(reading);
  }

  [[nodiscard]] core::EncoderReading read() noexcept { return line_.value(); }

  /// Precondition of both: axis < kAxes.
  void inject(std::uint32_t axis, EncoderFault fault) { fault_[axis] = fault; }
  /// Adds a permanent offset to the count.
  void jump(std::uint32_t axis, std::int32_t counts) {
    offset_[axis] += static_cast<std::uint32_t>(counts);
  }

 private:
  EncoderParameters parameters_;
  DelayLine<core::EncoderReading> line_;
  EncoderFault fault_[core::kAxes] = {};
  std::uint32_t offset_[core::kAxes] = {};
  std::uint32_t held_[core::kAxes] = {};
};

}  // namespace tactree::hal::sim
