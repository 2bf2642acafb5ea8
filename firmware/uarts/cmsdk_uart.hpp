#pragma once
// Serial port of Arm's MPS boards, polled (Arm DDI 0479D, "Cortex-M System Design Kit", APB
// UART).
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::firmware {

template <std::uint32_t kAddress>
class CmsdkUart {
 public:
  /// `clock_hz` is the frequency of the bus clock.
  void start(std::uint32_t clock_hz, std::uint32_t baud) {
    word(kDivider) = clock_hz / baud;
    word(kControl) = kSendAndReceive;
  }
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (word(kState) & kReceived) != 0U) {  // bound: bytes_size
      bytes[count] = static_cast<std::byte>(word(kData));
      ++count;
    }
    return count;
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (word(kState) & kSending) == 0U) {  // bound: bytes_size
      word(kData) = static_cast<std::uint32_t>(bytes[count]);
      ++count;
    }
    return count;
  }

 private:
  static constexpr std::uint32_t kData = 0x00;
  static constexpr std::uint32_t kState = 0x04;
  static constexpr std::uint32_t kControl = 0x08;
  static constexpr std::uint32_t kDivider = 0x10;
  static constexpr std::uint32_t kSending = 1U << 0;
  static constexpr std::uint32_t kReceived = 1U << 1;
  static constexpr std::uint32_t kSendAndReceive = 0x3;

  static volatile std::uint32_t& word(std::uint32_t offset) {
    return *reinterpret_cast<volatile std::uint32_t*>(kAddress + offset);
  }
};

}  // namespace tactree::firmware
