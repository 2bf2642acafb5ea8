#pragma once
// CRC-32 (IEEE 802.3, reflected, polynomial 0xEDB88320): detects accidental damage of blobs and
// messages. It does not protect against forgery.
//
// Interrupt safety: no shared state.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

/// Incremental checksum. Cost: about 10 instructions per byte. Flash: a table of 64 bytes.
class Crc32 {
 public:
  void update(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

/// Checksum of `bytes`.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace tactree::core
