#pragma once
// Simulated NOR flash, stricter than a real one: writing to bytes that are not erased fails and
// counts as a mistake. A power cut may interrupt any operation.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "tactree/hal/flash.hpp"

namespace tactree::hal::sim {

class SimFlash {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  explicit SimFlash(const FlashGeometry& geometry)
      : geometry_(geometry),
        words_(std::size_t{geometry.sector_bytes} * geometry.sectors / sizeof(std::uint32_t),
               0xFFFFFFFFU),
        written_(std::size_t{geometry.sector_bytes} * geometry.sectors / geometry.program_bytes),
        erased_times_(geometry.sectors) {}

  [[nodiscard]] FlashGeometry geometry() const noexcept { return geometry_; }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    return std::as_bytes(std::span(words_));
  }

  [[nodiscard]] bool erase(std::uint32_t sector) noexcept {
    if (sector >= geometry_.sectors) {
      ++mistakes_;
      return false;
    }
    const Fate fate = next_operation();
    if (fate == Fate::kNothing) {
      return false;
    }
    const std::size_t begin = std::size_t{sector} * geometry_.sector_bytes;
    if (fate == Fate::kHalf) {
      spoil(begin, geometry_.sector_bytes);
      return false;
    }
    fill(begin, geometry_.sector_bytes, std::byte{0xFF}, false);
    ++erased_times_[sector];
    return true;
  }

  /// Writes in units of program_bytes; each unit is one operation.
  [[nodiscard]] bool program(std::uint32_t offset, std::span<const std::byte> bytes) noexcept {
    const std::size_t unit = geometry_.program_bytes;
    if (offset % unit != 0U || bytes.size() % unit != 0U || bytes.size() > this->bytes().size() ||
        offset > this->bytes().size() - bytes.size()) {
      ++mistakes_;
      return false;
    }
    for (std::size_t at = 0; at < bytes.size(); at += unit) {  // bound: bytes
      if (!program_piece(offset + at, bytes.subspan(at, unit))) {
        return false;
      }
    }
    return true;
  }

  /// Cuts the power during the operation with this number, counted from power_on(). `done` is the
  /// part of it that is executed: 0 none, 1 half, 2 all. Later operations have no effect.
  void cut_power_at(std::uint64_t operation, int done) {
    cut_at_ = operation;
    done_ = static_cast<Fate>(done);
  }
  void power_on() {
    operations_ = 0;
    cut_at_ = kNever;
  }
  [[nodiscard]] std::uint64_t operations() const { return operations_; }
  [[nodiscard]] bool has_power() const { return operations_ <= cut_at_; }

  /// Inverts bits, to simulate ageing.
  void rot(std::size_t offset, std::uint8_t bits) {
    writable()[offset] ^= static_cast<std::byte>(bits);
  }
  /// Restores saved content.
  void restore(std::span<const std::byte> saved) {
    for (std::size_t i = 0; i < saved.size(); ++i) {  // bound: saved
      writable()[i] = saved[i];
    }
    const std::size_t unit = geometry_.program_bytes;
    for (std::size_t piece = 0; piece < written_.size(); ++piece) {  // bound: pieces
      bool blank = true;
      for (std::size_t i = 0; i < unit; ++i) {  // bound: unit
        blank = blank && writable()[piece * unit + i] == std::byte{0xFF};
      }
      written_[piece] = !blank;
    }
  }

  /// Number of writes to bytes that were not erased, and of misaligned or out-of-range operations.
  [[nodiscard]] std::uint32_t mistakes() const { return mistakes_; }
  [[nodiscard]] std::uint32_t erased_times(std::uint32_t sector) const {
    return erased_times_[sector];
  }
  /// Seed of the random content of interrupted operations.
  void seed(std::uint32_t seed) { random_.seed(seed); }

 private:
  enum class Fate : int { kNothing = 0, kHalf = 1, kWhole = 2 };

  Fate next_operation() {
    const std::uint64_t number = operations_;
    ++operations_;
    if (number < cut_at_) {
      return Fate::kWhole;
    }
    return number == cut_at_ ? done_ : Fate::kNothing;
  }

  bool program_piece(std::size_t offset, std::span<const std::byte> bytes) {
    const Fate fate = next_operation();
    if (fate == Fate::kNothing) {
      return false;
    }
    const std::size_t piece = offset / geometry_.program_bytes;
    if (written_[piece]) {
      ++mistakes_;
      return false;
    }
    written_[piece] = true;
    for (std::size_t i = 0; i < bytes.size(); ++i) {  // bound: bytes
      const auto random = static_cast<std::byte>(random_());
      writable()[offset + i] = fate == Fate::kWhole ? bytes[i] : bytes[i] | random;
    }
    return fate == Fate::kWhole && operations_ <= cut_at_;
  }

  void spoil(std::size_t begin, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {  // bound: size
      writable()[begin + i] |= static_cast<std::byte>(random_());
    }
    mark(begin, size, true);
  }
  void fill(std::size_t begin, std::size_t size, std::byte value, bool written) {
    for (std::size_t i = 0; i < size; ++i) {  // bound: size
      writable()[begin + i] = value;
    }
    mark(begin, size, written);
  }
  void mark(std::size_t begin, std::size_t size, bool written) {
    const std::size_t unit = geometry_.program_bytes;
    for (std::size_t i = begin / unit; i < (begin + size) / unit; ++i) {  // bound: pieces
      written_[i] = written;
    }
  }
  [[nodiscard]] std::span<std::byte> writable() {
    return std::as_writable_bytes(std::span(words_));
  }

  FlashGeometry geometry_;
  std::vector<std::uint32_t> words_;
  std::vector<bool> written_;
  std::vector<std::uint32_t> erased_times_;
  std::uint64_t operations_ = 0;
  std::uint64_t cut_at_ = kNever;
  Fate done_ = Fate::kNothing;
  std::uint32_t mistakes_ = 0;
  std::mt19937 random_{1};
};

static_assert(Flash<SimFlash>);

}  // namespace tactree::hal::sim
