#pragma once
// Detects an encoder that is stuck, or that is disconnected but reads as valid: the count of a
// working axis changes when the effort of its motor changes by more than kChange.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device/device_model.hpp"

namespace tactree::core {

class EncoderWatch {
 public:
  /// Change of effort / effort_max above which the count of an axis must change.
  static constexpr float kChange = 0.25F;
  /// The first 1 / kSettling of a standstill is ignored: the effort may still follow the motion
  /// that has just ended.
  static constexpr std::uint32_t kSettling = 4;

  /// `ticks`: maximum standstill of an axis under a changing effort; at least 1.
  void configure(std::uint32_t ticks) { ticks_ = ticks; }
  void reset();

  /// Call once per tick. `counts`: as read. `share`: contact effort / effort_max, without gravity
  /// compensation. `axes`: number of axes in use. Returns false if an encoder is stuck. Cost:
  /// constant.
  [[nodiscard]] bool update(const std::int32_t (&counts)[kAxes], const float (&share)[kAxes],
                            std::uint32_t axes);

 private:
  std::uint32_t ticks_ = 100;
  bool following_ = false;
  std::int32_t count_[kAxes] = {0, 0, 0};
  std::uint32_t still_[kAxes] = {0, 0, 0};  // ticks since the count changed
  float lowest_[kAxes] = {0.0F, 0.0F, 0.0F};
  float highest_[kAxes] = {0.0F, 0.0F, 0.0F};
};

}  // namespace tactree::core
