#pragma once
// Flash of an emulated board, simulated in RAM. Its content is kept across a reset of the board and
// erased at the start of each emulation.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/hal/flash.hpp"

extern "C" {
extern std::byte store_begin[];  // defined by the linker script
extern std::byte store_end[];
}

namespace tactree::firmware {

class RamFlash {
 public:
  /// Erases everything unless the mark of an earlier start is present.
  void prepare() {
    if (mark() == kMark) {
      return;
    }
    for (std::uint32_t i = 0; i < geometry().sectors; ++i) {  // bound: sectors
      (void)erase(i);
    }
    mark() = kMark;
  }

  /// Excludes the last sector, which holds the mark.
  [[nodiscard]] hal::FlashGeometry geometry() const noexcept {
    const auto bytes = static_cast<std::uint32_t>(store_end - store_begin);
    return {kSectorBytes, bytes / kSectorBytes - 1U, 4};
  }
  [[nodiscard]] std::span<const std::byte> bytes() const noexcept {
    return {store_begin, geometry().sectors * kSectorBytes};
  }
  [[nodiscard]] bool erase(std::uint32_t sector) noexcept {
    if (sector >= geometry().sectors) {
      return false;
    }
    __builtin_memset(store_begin + sector * kSectorBytes, 0xFF, kSectorBytes);
    return true;
  }
  [[nodiscard]] bool program(std::uint32_t offset, std::span<const std::byte> data) noexcept {
    if (offset > bytes().size() || data.size() > bytes().size() - offset) {
      return false;
    }
    for (std::size_t i = 0; i < data.size(); ++i) {  // bound: data_size
      store_begin[offset + i] &= data[i];
    }
    return true;
  }

 private:
  static constexpr std::uint32_t kSectorBytes = 16384;
  static constexpr std::uint32_t kMark = 0x464C5348;

  [[nodiscard]] std::uint32_t& mark() const {
    return *reinterpret_cast<std::uint32_t*>(store_begin + geometry().sectors * kSectorBytes);
  }
};

static_assert(hal::Flash<RamFlash>);

}  // namespace tactree::firmware
