// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/absolute_ticker.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <ctime>

#include "monotonic_time.hpp"

namespace tactree::hal::linux_time {
namespace {

void sleep_until(std::uint64_t due_ns) noexcept {
  timespec due{};
  due.tv_sec = static_cast<time_t>(due_ns / kNsPerSecond);
  due.tv_nsec = static_cast<decltype(due.tv_nsec)>(due_ns % kNsPerSecond);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) ==
         EINTR) {  // bound: signals
  }
}

// Only one thread writes, so an atomic read-modify-write is not needed.
void raise_by(std::atomic<std::uint64_t>& value, std::uint64_t amount) {
  value.store(value.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
}

}  // namespace

void LatenessHistogram::add(std::uint64_t late_ns) noexcept {
  const auto bucket = static_cast<std::uint32_t>(std::bit_width(late_ns / 1000U));
  raise_by(buckets_[std::min(bucket, kBuckets - 1U)], 1);
  raise_by(count_, 1);
  raise_by(sum_ns_, late_ns);
  min_ns_.store(std::min(min_ns_.load(std::memory_order_relaxed), late_ns),
                std::memory_order_relaxed);
  max_ns_.store(std::max(max_ns(), late_ns), std::memory_order_relaxed);
}

std::uint64_t LatenessHistogram::min_ns() const {
  return count() == 0 ? 0 : min_ns_.load(std::memory_order_relaxed);
}

double LatenessHistogram::mean_ns() const {
  const auto sum = static_cast<double>(sum_ns_.load(std::memory_order_relaxed));
  return count() == 0 ? 0.0 : sum / static_cast<double>(count());
}

Tick AbsoluteTicker::wait() noexcept {
  if (due_ns_ == 0) {
    due_ns_ = now_ns() + period_ns_;
  }
  sleep_until(due_ns_);
  const std::uint64_t now = now_ns();
  const std::uint64_t late_ns = now > due_ns_ ? now - due_ns_ : 0;
  lateness_.add(late_ns);
  // Missed ticks are skipped, because a burst of ticks would repeat old outputs.
  const std::uint64_t missed = late_ns / period_ns_;
  due_ns_ += (missed + 1U) * period_ns_;
  raise_by(missed_, missed);
  return {static_cast<std::uint32_t>(std::min<std::uint64_t>(missed, 0xFFFFFFFFU))};
}

std::uint32_t AbsoluteTicker::now_us() noexcept {
  return static_cast<std::uint32_t>(now_ns() / 1000U);
}

std::uint64_t AbsoluteTicker::left_ns() const noexcept {
  const std::uint64_t now = now_ns();
  return now < due_ns_ ? due_ns_ - now : 0;
}

}  // namespace tactree::hal::linux_time
