#pragma once
// Quadrature encoders on timers that count both edges of both tracks (RM0090, section 18.3.12). A
// counter cannot detect a broken wire, so an axis is invalid only if its timer is misconfigured.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"
#include "tactree/core/control/controller.hpp"

namespace tactree::firmware::stm32f4 {

enum class CounterWidth : std::uint32_t { k16 = 0xFFFF, k32 = 0xFFFFFFFF };

namespace encoder {
inline constexpr std::uint32_t kBothEdges = 0x3U;     // SMCR: SMS
inline constexpr std::uint32_t kSlaveMask = 0x7U;     // SMCR: SMS
inline constexpr std::uint32_t kEightSamples = 0x3U;  // CCMR1: filter, eight samples at full clock
inline constexpr std::uint32_t kTracks = 0x0101U | (kEightSamples << 4) | (kEightSamples << 12);
inline constexpr std::uint32_t kCount = 1U << 0;  // CR1: CEN
}  // namespace encoder

template <class Word>
class QuadratureCounter {
 public:
  QuadratureCounter(TimerBlock<Word>& timer, CounterWidth width) : timer_(timer), width_(width) {}

  /// Starts counting at zero. Precondition: the clock of the timer is enabled.
  void start() {
    timer_.smcr = encoder::kBothEdges;
    timer_.ccmr1 = encoder::kTracks;
    timer_.ccer = 0U;  // neither track inverted
    timer_.arr = static_cast<std::uint32_t>(width_);
    timer_.cnt = 0U;
    timer_.cr1 = encoder::kCount;
    count_ = last_ = 0U;
  }

  /// True if the timer's registers hold the values written by start().
  [[nodiscard]] bool runs() const {
    return has(timer_.cr1, encoder::kCount) && has(timer_.ccmr1, encoder::kTracks) &&
           (read(timer_.smcr) & encoder::kSlaveMask) == encoder::kBothEdges;
  }

  /// Returns the count, extended to 32 bits. Precondition for a 16-bit timer: it moves by at most
  /// 32 767 counts between two calls.
  [[nodiscard]] std::int32_t take() {
    const std::uint32_t now = read(timer_.cnt) & static_cast<std::uint32_t>(width_);
    std::uint32_t moved = now - last_;
    if (width_ == CounterWidth::k16) {
      moved = static_cast<std::uint32_t>(
          static_cast<std::int32_t>(static_cast<std::int16_t>(moved & 0xFFFFU)));
    }
    last_ = now;
    count_ += moved;
    return static_cast<std::int32_t>(count_);
  }

 private:
  TimerBlock<Word>& timer_;
  CounterWidth width_;
  std::uint32_t count_ = 0;
  std::uint32_t last_ = 0;
};

/// The counters of the axes, read within one microsecond. Safe in the tick. Call from one context
/// only.
template <class Word>
class QuadratureEncoders {
 public:
  QuadratureEncoders(const QuadratureCounter<Word>& x, const QuadratureCounter<Word>& y,
                     const QuadratureCounter<Word>& z)
      : axis_{x, y, z} {}

  /// Returns false if a timer does not run.
  [[nodiscard]] bool start() {
    bool good = true;
    for (QuadratureCounter<Word>& counter : axis_) {  // bound: kAxes
      counter.start();
      good = counter.runs() && good;
    }
    return good;
  }

  [[nodiscard]] core::EncoderReading read() noexcept {
    core::EncoderReading reading;
    for (std::uint32_t i = 0; i < core::kAxes; ++i) {  // bound: kAxes
      reading.counts[i] = axis_[i].take();
      reading.valid[i] = axis_[i].runs();
    }
    return reading;
  }

 private:
  QuadratureCounter<Word> axis_[core::kAxes];
};

}  // namespace tactree::firmware::stm32f4
