#pragma once
// The 16550 UART, polled (TI, "TL16C550C", SLLS177). start() does not change the baud rate.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::firmware {

template <std::uint32_t kAddress>
class Ns16550Uart {
 public:
  void start(std::uint32_t, std::uint32_t) { byte(kFifoControl) = kFifoOn; }
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (byte(kLineStatus) & kReceived) != 0U) {  // bound: bytes_size
      bytes[count] = static_cast<std::byte>(byte(kData));
      ++count;
    }
    return count;
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (byte(kLineStatus) & kEmpty) != 0U) {  // bound: bytes_size
      byte(kData) = static_cast<std::uint8_t>(bytes[count]);
      ++count;
    }
    return count;
  }

 private:
  static constexpr std::uint32_t kData = 0;
  static constexpr std::uint32_t kFifoControl = 2;
  static constexpr std::uint32_t kLineStatus = 5;
  static constexpr std::uint8_t kFifoOn = 0x07;
  static constexpr std::uint8_t kReceived = 1U << 0;
  static constexpr std::uint8_t kEmpty = 1U << 5;

  static volatile std::uint8_t& byte(std::uint32_t offset) {
    return *reinterpret_cast<volatile std::uint8_t*>(kAddress + offset);
  }
};

}  // namespace tactree::firmware
