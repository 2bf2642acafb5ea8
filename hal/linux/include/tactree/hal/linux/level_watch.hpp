#pragma once
// Detects lost edges: the level of a line differs from its level after the last processed edge, and
// the edge in between is not delivered within a time limit.

#include <cstdint>

namespace tactree::hal::linux_gpio {

/// In all bit sets, bit n is line n.
class LevelWatch {
 public:
  explicit LevelWatch(std::uint64_t limit_ns) : limit_ns_(limit_ns) {}

  /// Call when an edge of these lines was processed: a later difference is a new one.
  void take(std::uint64_t lines) { differ_ &= ~lines; }

  /// `differ`: lines that differ now; `held`: lines with edges that are not processed yet. Returns
  /// the lines that have differed in all calls during the time limit: their edges were lost.
  /// Afterwards they are observed anew.
  [[nodiscard]] std::uint64_t look(std::uint64_t differ, std::uint64_t held, std::uint64_t now_ns) {
    differ &= ~held;
    differ_ &= differ;
    if (differ_ == 0U) {
      differ_ = differ;
      since_ns_ = now_ns;
      return 0;
    }
    if (now_ns - since_ns_ < limit_ns_) {
      return 0;
    }
    const std::uint64_t lost = differ_;
    differ_ = 0;
    return lost;
  }

 private:
  std::uint64_t limit_ns_;
  std::uint64_t differ_ = 0;  // in all calls since since_ns_
  std::uint64_t since_ns_ = 0;
};

}  // namespace tactree::hal::linux_gpio
