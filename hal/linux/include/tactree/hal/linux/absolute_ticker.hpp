#pragma once
// Ticks of a control loop at absolute times, and statistics of their lateness. A late tick does not
// shift the ticks after it.

#include <array>
#include <atomic>
#include <cstdint>

#include "tactree/hal/board.hpp"

namespace tactree::hal::linux_time {

/// Histogram of the delay between the due time and the start of a tick. One thread adds; any thread
/// may read concurrently. Each value is read atomically.
class LatenessHistogram {
 public:
  /// Bucket 0 counts delays below 1 us, bucket n those from 2^(n-1) to below 2^n us, and the last
  /// bucket all from 2^20 us, about 1 s.
  static constexpr std::uint32_t kBuckets = 22;

  /// Cost: constant.
  void add(std::uint64_t late_ns) noexcept;

  [[nodiscard]] std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t max_ns() const { return max_ns_.load(std::memory_order_relaxed); }
  /// Returns 0 before the first tick.
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

/// A Ticker (board.hpp) on CLOCK_MONOTONIC. wait() is for the thread of the loop only; lateness()
/// and missed() for any thread.
class AbsoluteTicker {
 public:
  /// Precondition: period_ns > 0.
  explicit AbsoluteTicker(std::uint64_t period_ns) : period_ns_(period_ns) {}

  /// Blocks until the next tick is due. The first call sets the time base and returns one period
  /// later.
  [[nodiscard]] Tick wait() noexcept;
  /// CLOCK_MONOTONIC in us, wrapping at 2^32.
  [[nodiscard]] std::uint32_t now_us() noexcept;

  /// Time until the next tick, ns; 0 if it is due.
  [[nodiscard]] std::uint64_t left_ns() const noexcept;
  [[nodiscard]] std::uint64_t period_ns() const { return period_ns_; }
  [[nodiscard]] const LatenessHistogram& lateness() const { return lateness_; }
  /// Deadlines missed since the start.
  [[nodiscard]] std::uint64_t missed() const { return missed_.load(std::memory_order_relaxed); }

 private:
  std::uint64_t period_ns_;
  std::uint64_t due_ns_ = 0;  // due time of the next tick
  std::atomic<std::uint64_t> missed_{0};
  LatenessHistogram lateness_;
};

static_assert(Ticker<AbsoluteTicker>);

}  // namespace tactree::hal::linux_time
