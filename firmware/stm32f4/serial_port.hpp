#pragma once
// A serial port that nobody waits for (RM0090, sections 30.3 and 10.3): DMA puts what comes in into
// a ring; what goes out is handed over two bytes a tick, as many as the port can hold.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

inline constexpr std::uint32_t kRingBytes = 256;

/// Memory that DMA writes. Not in the core-coupled RAM, which DMA does not reach (section 2.3.1).
struct Ring {
  volatile std::uint8_t byte[kRingBytes];
};

namespace serial {
inline constexpr std::uint32_t kEmpty = 1U << 7;                          // SR: TXE
inline constexpr std::uint32_t kOn = (1U << 13) | (1U << 3) | (1U << 2);  // CR1: UE, TE, RE
inline constexpr std::uint32_t kReceiveByDma = 1U << 6;                   // CR3: DMAR
inline constexpr std::uint32_t kChannel4 = 4U << 25;                      // stream's CR
inline constexpr std::uint32_t kCircularBytes = (1U << 8) | (1U << 10);   // stream's CR
inline constexpr std::uint32_t kStreamOn = 1U << 0;                       // stream's CR
inline constexpr std::uint32_t kStream2Flags = 0x3DU << 16;               // LIFCR
inline constexpr std::uint32_t kStreamPolls = 1000;
inline constexpr std::uint32_t kBytesPerTick = 2;
}  // namespace serial

/// USART1 with stream 2 of DMA2, channel 4 (table 43).
template <class Word>
class SerialPort {
 public:
  SerialPort(UsartBlock<Word>& usart, DmaBlock<Word>& dma, Ring& ring)
      : usart_(usart), dma_(dma), ring_(ring) {}

  /// `clock_hz` of the port's bus. 8 data bits, no parity, one stop bit.
  void start(std::uint32_t clock_hz, std::uint32_t baud) {
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
    usart_.brr = (clock_hz + baud / 2U) / baud;
    usart_.cr3 = serial::kReceiveByDma;
    usart_.cr1 = serial::kOn;
    next_ = 0;
  }

  /// The next byte that came in. False: there is none. More than a ring full between two looks is
  /// lost, as a checksum will tell.
  [[nodiscard]] bool take(std::byte& byte) {
    const std::uint32_t written = (kRingBytes - read(dma_.stream[2].ndtr)) % kRingBytes;
    if (next_ == written) {
      return false;
    }
    byte = static_cast<std::byte>(ring_.byte[next_]);
    next_ = (next_ + 1U) % kRingBytes;
    return true;
  }

  /// All of the last message is handed over.
  [[nodiscard]] bool idle() const { return sent_ == waiting_.size(); }

  /// Precondition: idle(). The bytes must stay until it is idle again.
  void send(std::span<const std::byte> bytes) {
    waiting_ = bytes;
    sent_ = 0;
  }

  /// Once a tick. Reading the status also clears an overrun, with DMA's next read (section 30.6.1).
  void advance() {
    for (std::uint32_t i = 0; i < serial::kBytesPerTick; ++i) {  // bound: kBytesPerTick
      if (!has(usart_.sr, serial::kEmpty) || idle()) {
        return;
      }
      usart_.dr = static_cast<std::uint32_t>(waiting_[sent_]);
      ++sent_;
    }
  }

 private:
  template <class T>
  static std::uint32_t address_of(const T* object) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object));
  }

  UsartBlock<Word>& usart_;
  DmaBlock<Word>& dma_;
  Ring& ring_;
  std::uint32_t next_ = 0;
  std::span<const std::byte> waiting_{};
  std::size_t sent_ = 0;
};

}  // namespace tactree::firmware::stm32f4
