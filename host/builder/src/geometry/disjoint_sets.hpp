#pragma once
// Sets of elements that are joined one pair at a time; the lowest element represents its set.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <vector>

namespace tactree::builder {

/// join() and find() may be called by several threads at once. The sets do not depend on the order
/// of the calls.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  /// Returns the lowest element of the set of `i`. Halves the path to it.
  [[nodiscard]] std::uint32_t find(std::uint32_t i) {
    for (std::uint32_t above = parent_of(i); above != i; above = parent_of(i)) {
      // Another thread may have stored a lower ancestor; both are valid.
      const std::uint32_t next = parent_of(above);
      at(i).store(next, std::memory_order_relaxed);
      i = next;
    }
    return i;
  }

  void join(std::uint32_t i, std::uint32_t j) {
    while (parent_of(i) != parent_of(j)) {
      const std::uint32_t a = find(i);
      const std::uint32_t b = find(j);
      std::uint32_t high = std::max(a, b);
      if (a == b ||
          at(high).compare_exchange_strong(high, std::min(a, b), std::memory_order_relaxed)) {
        return;
      }
    }
  }

 private:
  [[nodiscard]] std::atomic_ref<std::uint32_t> at(std::uint32_t i) {
    return std::atomic_ref(parent_[i]);
  }
  [[nodiscard]] std::uint32_t parent_of(std::uint32_t i) {
    return at(i).load(std::memory_order_relaxed);
  }

  std::vector<std::uint32_t> parent_;
};

}  // namespace tactree::builder
