#pragma once
// Quadrature decoder for boards without a hardware counter: counts an incremental encoder from the
// levels of its two lines, four counts per period.
//
// Interrupt safety: no shared state; one context owns a decoder.

#include <cstdint>

namespace tactree::core {

/// Levels of both lines. In the forward direction (b a) is 00, 01, 11, 10: line a leads.
struct QuadratureLevels {
  bool a = false;
  bool b = false;
  friend constexpr bool operator==(QuadratureLevels, QuadratureLevels) = default;
};

class QuadratureDecoder {
 public:
  /// Sets the current levels and keeps the count.
  void begin(QuadratureLevels now) { levels_ = now; }

  /// Processes new levels. If both lines changed at once, the direction is unknown: illegal() is
  /// incremented instead of the count. Cost: constant.
  void step(QuadratureLevels now) {
    const std::uint32_t quarter = (quarter_of(now) - quarter_of(levels_)) & 3U;
    levels_ = now;
    if (quarter == 1U) {
      ++count_;
    } else if (quarter == 3U) {
      --count_;
    } else if (quarter == 2U) {
      ++illegal_;
    }
  }

  [[nodiscard]] std::uint32_t count() const { return count_; }  ///< wraps around at 2^32
  [[nodiscard]] std::uint32_t illegal() const { return illegal_; }
  [[nodiscard]] QuadratureLevels levels() const { return levels_; }

 private:
  /// Position in the period: 0 .. 3.
  [[nodiscard]] static constexpr std::uint32_t quarter_of(QuadratureLevels levels) {
    const std::uint32_t a = levels.a ? 1U : 0U;
    const std::uint32_t b = levels.b ? 1U : 0U;
    return (b << 1U) | (a ^ b);
  }

  QuadratureLevels levels_{};
  std::uint32_t count_ = 0;
  std::uint32_t illegal_ = 0;
};

}  // namespace tactree::core
