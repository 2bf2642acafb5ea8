#pragma once
// A value as it was some ticks ago.

#include <cstdint>

namespace tactree::hal::sim {

inline constexpr std::uint32_t kMaxLatencyTicks = 63;

/// push() once a tick; value() is what was pushed `latency` pushes before the last. Before there
/// were so many, it is the initial value.
template <class T>
class DelayLine {
 public:
  /// latency_ticks: 0 .. kMaxLatencyTicks; larger is taken as the largest.
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
