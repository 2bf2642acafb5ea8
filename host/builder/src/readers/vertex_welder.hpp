#pragma once
// Merges bitwise equal points, for formats that repeat a point in each of its faces.

#include <array>
#include <bit>
#include <cstdint>
#include <random>
#include <vector>

namespace tactree::builder {

class VertexWelder {
 public:
  using Position = std::array<float, 3>;

  /// Returns the index of `position` among the distinct positions, in order of first occurrence.
  std::uint32_t add(Position position) {
    for (float& coordinate : position) coordinate += 0.0F;  // -0 equals 0
    if (2 * (positions_.size() + 1) > table_.size()) grow();
    std::uint32_t& entry = find(position);
    if (entry == kFree) {
      entry = static_cast<std::uint32_t>(positions_.size());
      positions_.push_back(position);
    }
    return entry;
  }

  [[nodiscard]] const std::vector<Position>& positions() const { return positions_; }
  /// Memory in use; the next add() at most doubles it.
  [[nodiscard]] std::uint64_t bytes() const {
    return positions_.capacity() * sizeof(Position) + table_.size() * sizeof(std::uint32_t);
  }

 private:
  static constexpr std::uint32_t kFree = 0xffff'ffff;
  using Bits = std::array<std::uint32_t, 3>;

  /// Salted per run, so that a crafted file cannot make all hashes equal.
  [[nodiscard]] std::size_t hash(const Position& position) const {
    std::uint64_t mixed = seed_;
    for (const std::uint32_t bits : std::bit_cast<Bits>(position)) {
      mixed = (mixed ^ bits) * 0x9e37'79b9'7f4a'7c15;
      mixed ^= mixed >> 29;
    }
    return static_cast<std::size_t>(mixed ^ (mixed >> 32));
  }

  /// Returns the entry of this position, or a free entry.
  std::uint32_t& find(const Position& position) {
    const std::size_t mask = table_.size() - 1;
    std::size_t at = hash(position) & mask;
    // Compares bitwise, so that a NaN equals itself.
    while (table_[at] != kFree &&
           std::bit_cast<Bits>(positions_[table_[at]]) != std::bit_cast<Bits>(position)) {
      at = (at + 1) & mask;
    }
    return table_[at];
  }

  void grow() {
    std::vector<std::uint32_t> larger(table_.empty() ? 1024 : 2 * table_.size(), kFree);
    table_.swap(larger);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      find(positions_[i]) = static_cast<std::uint32_t>(i);
    }
  }

  std::vector<Position> positions_;
  std::vector<std::uint32_t> table_;  // indices into positions_, at most half full
  std::uint64_t seed_ = std::random_device{}();
};

}  // namespace tactree::builder
