#pragma once
// A counter that stands still although its motor pulls: a stuck encoder, or one whose wire is off
// but reads as valid. A good one cannot: where the effort of an axis changes by much, the axis
// gives by at least a count.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/device_model.hpp"

namespace tactree::core {

class EncoderWatch {
 public:
  /// Change of an axis's effort, as a share of its effort_max, that must move it.
  static constexpr float kChange = 0.25F;
  /// One part of so many of the time: the effort may still follow the motion that has ended.
  static constexpr std::uint32_t kSettling = 4;

  /// ticks: that an axis may stand still while its effort changes; at least 1.
  void configure(std::uint32_t ticks) { ticks_ = ticks; }
  void reset();

  /// One tick: the counts read, and the effort of the contact, without the device's own weight, as
  /// a share of effort_max. False: the encoder of an axis is stuck. Cost: constant.
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
