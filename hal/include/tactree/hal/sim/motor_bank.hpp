#pragma once
// Motors of a simulated device: force limit, latency, faults.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/safety/safety_gate.hpp"
#include "tactree/hal/sim/delay_line.hpp"

namespace tactree::hal::sim {

enum class MotorFault : std::uint8_t {
  kNone = 0,
  kDead,      ///< no effort
  kStuck,     ///< keeps its effort
  kReversed,  ///< wrong sign
};

struct MotorParameters {
  double effort_max = 8.5;          ///< saturation limit of each axis, N or Nm
  std::uint32_t latency_ticks = 0;  ///< from the write to the effort: 0 .. kMaxLatencyTicks
};

class SimMotorBank {
 public:
  explicit SimMotorBank(const MotorParameters& parameters)
      : parameters_(parameters),
        weak_(parameters.effort_max),
        line_(parameters.latency_ticks, Efforts{}) {}

  void write(const core::MotorCommand& command) noexcept {
    hold({command.effort(0), command.effort(1), command.effort(2)});
  }

  /// Sets the efforts commanded by an external board, N or Nm.
  void hold(const float (&effort)[core::kAxes]) noexcept {
    Efforts efforts;
    for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
      efforts.axis[i] = static_cast<double>(effort[i]);
    }
    line_.push(efforts);
  }

  [[nodiscard]] bool healthy() noexcept { return healthy_; }

  /// Current effort of an axis, N or Nm; zero while `powered` is false.
  /// Precondition: axis < kAxes.
  [[nodiscard]] double effort(std::uint32_t axis, bool powered) {
    double wanted = line_.value().axis[axis];
    wanted = fault_[axis] == MotorFault::kDead ? 0.0 : wanted;
    wanted = fault_[axis] == MotorFault::kReversed ? -wanted : wanted;
    wanted = fault_[axis] == MotorFault::kStuck ? held_[axis] : wanted;
    held_[axis] = wanted;
    if (!powered) {
      return 0.0;
    }
    const double limit = weak_ < parameters_.effort_max ? weak_ : parameters_.effort_max;
    return wanted > limit ? limit : (wanted < -limit ? -limit : wanted);
  }

  /// Precondition: axis < kAxes.
  void inject(std::uint32_t axis, MotorFault fault) { fault_[axis] = fault; }
  void set_healthy(bool healthy) { healthy_ = healthy; }

  /// Limits the effort of all motors, N or Nm.
  void saturate(double effort) { weak_ = effort; }
  void saturate_as_built() { weak_ = parameters_.effort_max; }

  [[nodiscard]] float supply_V() noexcept { return supply_V_; }
  void set_supply(float volts) { supply_V_ = volts; }
  void supply_as_built() { supply_V_ = kSupplyVolts; }

 private:
  struct Efforts {
    double axis[core::kAxes] = {0.0, 0.0, 0.0};
  };

  MotorParameters parameters_;
  double weak_;
  DelayLine<Efforts> line_;
  MotorFault fault_[core::kAxes] = {};
  double held_[core::kAxes] = {0.0, 0.0, 0.0};
  bool healthy_ = true;
  static constexpr float kSupplyVolts = 24.0F;  // between the default limits, 18 and 30 V
  float supply_V_ = kSupplyVolts;
};

}  // namespace tactree::hal::sim
