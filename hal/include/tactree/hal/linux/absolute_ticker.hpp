#pragma once
// The heartbeat of a control loop on Linux: ticks at absolute times, so that being late once does
// not move those that follow; and how late each was.

#include <array>
#include <atomic>
#include <cstdint>

#include "tactree/hal/board.hpp"

namespace tactree::hal::linux_time {

/// How late ticks began, after the moment that they were due. One thread adds; any may read
/// meanwhile, and sees each figure whole.
class LatenessHistogram {
 public:
  /// Bucket 0: below 1 us; n: 2^(n-1) up to 2^n us; the last one: all above.
  static constexpr std::uint32_t kBuckets = 22;

  /// Cost: constant.
  void add(std::uint64_t late_ns) noexcept;

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t max_ns() const { return max_ns_.load(std::memory_order_relaxed); }
  /// 0 before the first.
  [[nodiscard]] std::uint64_t min_ns() const;
  [[nodiscard]] double mean_ns() const;
  /// Precondition: bucket < kBuckets.
  [[nodiscard]] std::uint64_t in_bucket(std::uint32_t bucket) const {
    return buckets_[bucket].load(std::memory_order_relaxed);
  }
  /// Upper end of a bucket, us. Precondition: bucket < kBuckets - 1.
  [[nodiscard]] static constexpr std::uint64_t end_us(std::uint32_t bucket) {
    return std::uint64_t{1} << bucket;
  }

 private:
  std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::uint64_t> sum_ns_{0};
  std::atomic<std::uint64_t> min_ns_{~std::uint64_t{0}};
  std::atomic<std::uint64_t> max_ns_{0};
};

/// A Ticker (board.hpp) on CLOCK_MONOTONIC.
class AbsoluteTicker {
 public:
  /// Precondition: period_ns > 0.
  explicit AbsoluteTicker(std::uint64_t period_ns) : period_ns_(period_ns) {}

  /// The first call sets the beat and returns one period later.
  [[nodiscard]] Tick wait() noexcept;
  [[nodiscard]] std::uint32_t now_us() noexcept;

  /// Until the next tick is due; 0: it is.
  [[nodiscard]] std::uint64_t left_ns() const noexcept;
  [[nodiscard]] std::uint64_t period_ns() const { return period_ns_; }
  [[nodiscard]] const LatenessHistogram& lateness() const { return lateness_; }
  /// Deadlines missed since the start.
  [[nodiscard]] std::uint64_t missed() const { return missed_.load(std::memory_order_relaxed); }

 private:
  std::uint64_t period_ns_;
  std::uint64_t due_ns_ = 0;  // of the tick that is waited for next
  std::atomic<std::uint64_t> missed_{0};
  LatenessHistogram lateness_;
};

static_assert(Ticker<AbsoluteTicker>);

}  // namespace tactree::hal::linux_time
