#pragma once
// Counts of an incremental encoder from the edges of its two lines, four a period. For boards that
// have no counter in hardware.
//
// Interrupt safe: pure functions on the caller's object.

#include <cstdint>

namespace tactree::core {

/// Both lines at one moment. Forward is the order 00, 01, 11, 10 (b a): a leads.
struct QuadratureLevels {
  bool a = false;
  bool b = false;
  friend constexpr bool operator==(QuadratureLevels, QuadratureLevels) = default;
};

class QuadratureDecoder {
 public:
  /// Where the lines are now; the count stays.
  void begin(QuadratureLevels now) { levels_ = now; }

  /// The lines are so from now on. Where both have changed at once the direction is not known:
  /// nothing is counted but one more illegal transition. Cost: constant.
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

  [[nodiscard]] std::uint32_t count() const { return count_; }  ///< wraps at 2^32
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
