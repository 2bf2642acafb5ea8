#pragma once
// CRC-32 (IEEE 802.3, reflected, polynomial 0xEDB88320): guards blobs and messages against
// accidents.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

/// Running checksum. Cost: about 10 instructions a byte; 64 bytes of table; interrupt safe.
class Crc32 {
 public:
  void update(std::span<const std::byte> bytes);
  [[nodiscard]] std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFU;
};

[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes);

}  // namespace tactree::core
