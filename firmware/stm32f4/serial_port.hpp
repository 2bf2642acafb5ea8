#pragma once
// A serial port that nobody waits for (RM0090, sections 30.3 and 10.3), as hal::BytePort: DMA puts
// what comes in into a ring; what goes out is handed over as fast as the port takes it, whenever
// somebody looks at the port.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

/// 41 ms at 1 000 000 baud: longer than a session looks away while the device may have force, and
/// more than all pieces of a model that an application has on their way at once.
inline constexpr std::uint32_t kRingBytes = 4096;

/// Memory that DMA writes. Not in the core-coupled RAM, which DMA does not reach (section 2.3.1).
struct Ring {
  volatile std::uint8_t byte[kRingBytes];
};

namespace serial {
inline constexpr std::uint32_t kFull = 1U << 5;                           // SR: RXNE
inline constexpr std::uint32_t kEmpty = 1U << 7;                          // SR: TXE
inline constexpr std::uint32_t kOn = (1U << 13) | (1U << 3) | (1U << 2);  // CR1: UE, TE, RE
inline constexpr std::uint32_t kReceiveByDma = 1U << 6;                   // CR3: DMAR
inline constexpr std::uint32_t kChannel4 = 4U << 25;                      // stream's CR
inline constexpr std::uint32_t kCircularBytes = (1U << 8) | (1U << 10);   // stream's CR
inline constexpr std::uint32_t kStreamOn = 1U << 0;                       // stream's CR
inline constexpr std::uint32_t kStream2Flags = 0x3DU << 16;               // LIFCR
inline constexpr std::uint32_t kStreamPolls = 1000;
}  // namespace serial

/// USART1 with stream 2 of DMA2, channel 4 (table 43).
template <class Word>
class SerialPort {
 public:
  SerialPort(UsartBlock<Word>& usart, DmaBlock<Word>& dma, Ring& ring)
      : usart_(usart), dma_(dma), ring_(ring) {}

  /// `clock_hz` of the port's bus, at least 16 times `baud`. 8 data bits, no parity, one stop bit.
  /// False: DMA does not run. Then a byte is taken where one waits, and what comes faster is lost:
  /// enough to ask the board what is the matter.
  [[nodiscard]] bool start(std::uint32_t clock_hz, std::uint32_t baud) {
    auto& stream = dma_.stream[2];
    clear(stream.cr, serial::kStreamOn);
    // The stream must be off before it takes settings (section 10.3.17).
    (void)wait_until(stream.cr, serial::kStreamOn, 0U, serial::kStreamPolls);
    dma_.lifcr = serial::kStream2Flags;
    stream.par = address_of(&usart_.dr);
    stream.m0ar = address_of(ring_.byte);
    stream.ndtr = kRingBytes;
    stream.cr = serial::kChannel4 | serial::kCircularBytes;
    set(stream.cr, serial::kStreamOn);
    by_dma_ = has(stream.cr, serial::kStreamOn) && stm32f4::read(stream.ndtr) != 0U;
    usart_.brr = (clock_hz + baud / 2U) / baud;
    usart_.cr3 = by_dma_ ? serial::kReceiveByDma : 0U;
    usart_.cr1 = serial::kOn;
    next_ = 0;
    return by_dma_;
  }

  /// More than a ring full between two looks is lost, as a checksum will tell.
  std::size_t read(std::span<std::byte> bytes) noexcept {
    advance();
    std::size_t count = 0;
    while (count < bytes.size() && take(bytes[count])) {  // bound: bytes_size
      ++count;
    }
    return count;
  }

  /// Takes nothing while there is something on its way.
  std::size_t write(std::span<const std::byte> bytes) noexcept {
    advance();
    if (sent_ != size_) {
      return 0;
    }
    size_ = bytes.size() < sizeof waiting_ ? bytes.size() : sizeof waiting_;
    __builtin_memcpy(waiting_, bytes.data(), size_);
    sent_ = 0;
    advance();
    return size_;
  }

 private:
  // Reading the status also clears an overrun, with the next read of a byte (section 30.6.1).
  void advance() {
    while (has(usart_.sr, serial::kEmpty) && sent_ < size_) {  // bound: waiting_bytes
      usart_.dr = static_cast<std::uint32_t>(waiting_[sent_]);
      ++sent_;
    }
  }

  bool take(std::byte& byte) {
    if (!by_dma_) {
      const bool came = has(usart_.sr, serial::kFull);
      byte = came ? static_cast<std::byte>(stm32f4::read(usart_.dr)) : std::byte{};
      return came;
    }
    const std::uint32_t written = (kRingBytes - stm32f4::read(dma_.stream[2].ndtr)) % kRingBytes;
    if (next_ == written) {
      return false;
    }
    byte = static_cast<std::byte>(ring_.byte[next_]);
    next_ = (next_ + 1U) % kRingBytes;
    return true;
  }

  template <class T>
  static std::uint32_t address_of(const T* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object));
  }

  UsartBlock<Word>& usart_;
  DmaBlock<Word>& dma_;
  Ring& ring_;
  bool by_dma_ = false;
  std::uint32_t next_ = 0;
  std::byte waiting_[256] = {};
  std::size_t size_ = 0;
  std::size_t sent_ = 0;
};

}  // namespace tactree::firmware::stm32f4
