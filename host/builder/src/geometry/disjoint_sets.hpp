#pragma once
// Sets of elements that are joined one pair at a time; the lowest element represents its set.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace tactree::builder {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  /// Returns the lowest element of the set of `i`. Halves the path to it.
  [[nodiscard]] std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void join(std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = find(i);
    const std::uint32_t b = find(j);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace tactree::builder
