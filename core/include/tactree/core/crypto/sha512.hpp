#pragma once
// SHA-512 (FIPS 180-4), for signatures.
//
// Interrupt safety: no shared state.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::core {

/// Incremental hash. Cost: about 40 instructions per byte on a 32-bit core; 208 bytes of RAM and
/// about 640 bytes of stack.
class Sha512 {
 public:
  static constexpr std::size_t kBytes = 64;

  void update(std::span<const std::byte> bytes);
  /// Writes the hash. Call it once, after the last update().
  void finish(std::span<std::uint8_t, kBytes> hash);

 private:
  static constexpr std::size_t kBlock = 128;

  void add_block();

  std::uint64_t state_[8] = {
      0x6A09E667F3BCC908, 0xBB67AE8584CAA73B, 0x3C6EF372FE94F82B, 0xA54FF53A5F1D36F1,
      0x510E527FADE682D1, 0x9B05688C2B3E6C1F, 0x1F83D9ABFB41BD6B, 0x5BE0CD19137E2179,
  };
  std::uint8_t block_[kBlock] = {};
  std::size_t used_ = 0;
  std::uint64_t total_ = 0;  // bytes
};

}  // namespace tactree::core
