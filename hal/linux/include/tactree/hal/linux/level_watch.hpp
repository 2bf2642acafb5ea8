#pragma once
// Lines whose level is not the one that their edges lead to: an edge was lost, unless it is on its
// way.

#include <cstdint>

namespace tactree::hal::linux_gpio {

/// Bit n of all sets is line n.
class LevelWatch {
 public:
  explicit LevelWatch(std::uint64_t limit_ns) : limit_ns_(limit_ns) {}

  /// An edge of these lines was processed: the next difference is another one.
  void take(std::uint64_t lines) { differ_ &= ~lines; }

  /// `differ`: the lines at this time; `held`: lines with edges that are not processed yet. Returns
  /// those that have differed at all looks of at least the limit: their edges never come. They
  /// count from now as equal.
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
  std::uint64_t differ_ = 0;  // at all looks since since_ns_
  std::uint64_t since_ns_ = 0;
};

}  // namespace tactree::hal::linux_gpio
