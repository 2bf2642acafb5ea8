#pragma once
// Delay of a value by a number of ticks.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

namespace tactree::hal::sim {

/// More than the controller compensates (core::kMaxDelayTicks). A power of two less one: the index
/// wraps without a division.
inline constexpr std::uint32_t kMaxLatencyTicks = 63;

/// Call push() once per tick. value() returns the value that was pushed latency_ticks pushes before
/// the last one, or the initial value if there were fewer. Cost: constant.
template <class T>
class DelayLine {
 public:
  /// latency_ticks: 0 .. kMaxLatencyTicks; larger values are clamped.
  DelayLine(std::uint32_t latency_ticks, const T& initial)
      : latency_(latency_ticks < kMaxLatencyTicks ? latency_ticks : kMaxLatencyTicks) {
    for (T& slot : slots_) {  // bound: slots
      slot = initial;
    }
  }

  void push(const T& value) {
    newest_ = (newest_ + 1U) % kSlots;
    slots_[newest_] = value;
  }

  [[nodiscard]] const T& value() const { return slots_[(newest_ + kSlots - latency_) % kSlots]; }

 private:
  static constexpr std::uint32_t kSlots = kMaxLatencyTicks + 1;
  T slots_[kSlots]{};
  std::uint32_t latency_;
  std::uint32_t newest_ = 0;
};

}  // namespace tactree::hal::sim
