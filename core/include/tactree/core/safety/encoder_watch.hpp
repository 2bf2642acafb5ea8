#pragma once
// Detects an encoder that is stuck, or that is disconnected but reads as valid: the count of a
// working axis changes when the force that moves it changes by more than kChange.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device/device_model.hpp"

namespace tactree::core {

class EncoderWatch {
 public:
  /// Change of the share above which the count of an axis must change. On the premium preset this
  /// is about 2 N at the probe, 50 times its friction: even a stiff hand then yields by more than
  /// ten counts. Less would report a fault when the motion of a hand cancels that of the force;
  /// with more, fewer stuck encoders are detected (docs/SAFETY.md).
  static constexpr float kChange = 0.25F;
  /// The first 1 / kSettling of a standstill is ignored: the force may still follow the motion that
  /// has just ended. The default, 125 ms, covers the window of the velocity (15 ms at 1 kHz), its
  /// filter (1 ms) and the slew limit from full effort (4 ms). If more were ignored, less of a
  /// standstill would be checked. An axis that has rested has the same time to follow a change of
  /// the force.
  static constexpr std::uint32_t kSettling = 4;

  /// `ticks`: maximum standstill of an axis under a changing force; at least 1. A short one reports
  /// a hand that happens to guide one axis to its turning point while the others press.
  void configure(std::uint32_t ticks) { ticks_ = ticks; }
  void reset();

  /// Call once per tick. `counts`: as read. `share`: of each axis, the contact force along the
  /// direction in which only this axis moves the most, as a share of the force of its effort_max;
  /// without gravity compensation. `axes`: number of axes in use. Returns false if an encoder is
  /// stuck. Cost: constant.
  [[nodiscard]] bool update(const std::int32_t (&counts)[kAxes], const float (&share)[kAxes],
                            std::uint32_t axes);

 private:
  std::uint32_t ticks_ = 100;
  bool following_ = false;
  std::int32_t count_[kAxes] = {0, 0, 0};
  std::uint32_t still_[kAxes] = {0, 0, 0};  // ticks since the count changed
  float lowest_[kAxes] = {0.0F, 0.0F, 0.0F};
  float highest_[kAxes] = {0.0F, 0.0F, 0.0F};
  std::uint32_t pushed_[kAxes] = {0, 0, 0};  // ticks since the share has changed by kChange
};

}  // namespace tactree::core
