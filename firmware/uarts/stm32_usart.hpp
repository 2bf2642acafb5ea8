#pragma once
// USART1 of an STM32F4, asked in turn (RM0090, section 30), as far as the emulated chip has it.

#include <cstddef>
#include <cstdint>
#include <span>

namespace tactree::firmware {

template <std::uint32_t kAddress>
class Stm32Usart {
 public:
  void start(std::uint32_t clock_hz, std::uint32_t baud) {
    word(kBaud) = clock_hz / baud;
    word(kControl) = kOn;
  }
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (word(kStatus) & kReceived) != 0U) {  // bound: bytes_size
      bytes[count] = static_cast<std::byte>(word(kData));
      ++count;
    }
    return count;
  }
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) noexcept {
    std::size_t count = 0;
    while (count < bytes.size() && (word(kStatus) & kEmpty) != 0U) {  // bound: bytes_size
      word(kData) = static_cast<std::uint32_t>(bytes[count]);
      ++count;
    }
    return count;
  }

 private:
  static constexpr std::uint32_t kStatus = 0x00;
  static constexpr std::uint32_t kData = 0x04;
  static constexpr std::uint32_t kBaud = 0x08;
  static constexpr std::uint32_t kControl = 0x0C;
  static constexpr std::uint32_t kReceived = 1U << 5;
  static constexpr std::uint32_t kEmpty = 1U << 7;
  static constexpr std::uint32_t kOn = (1U << 13) | (1U << 3) | (1U << 2);

  static volatile std::uint32_t& word(std::uint32_t offset) {
    return *reinterpret_cast<volatile std::uint32_t*>(kAddress + offset);
  }
};

}  // namespace tactree::firmware
