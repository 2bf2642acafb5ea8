#pragma once
// A non-blocking serial port (RM0090, sections 30.3 and 10.3), a hal::BytePort. DMA writes received
// bytes to a ring buffer. read() and write() move bytes to send from a buffer to the port.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

/// 41 ms at 1 000 000 baud. This is longer than the interval between two polls by a session while
/// the motors may be active, and more than an application sends of a model before it waits for a
/// reply.
inline constexpr std::uint32_t kRingBytes = 4096;

/// Buffer of the DMA. It must not be in the core-coupled RAM, which DMA cannot access (section
/// 2.3.1).
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
inline constexpr std::uint32_t kStreamPolls = 1000;  // of about ten cycles: 60 us at 168 MHz
}  // namespace serial

/// USART1 with stream 2 of DMA2, channel 4 (table 43). Call from one context only, outside the
/// tick.
template <class Word>
class SerialPort {
 public:
  SerialPort(UsartBlock<Word>& usart, DmaBlock<Word>& dma, Ring& ring)
      : usart_(usart), dma_(dma), ring_(ring) {}

  /// `clock_hz` is the clock of the bus, at least 16 times `baud`. 8 data bits, no parity, one stop
  /// bit. Returns false if DMA does not run. The port then receives by polling and loses bytes that
  /// arrive faster than it is polled, which is enough for an application to query the cause.
  [[nodiscard]] bool start(std::uint32_t clock_hz, std::uint32_t baud) {
    auto& stream = dma_.stream[2];
    clear(stream.cr, serial::kStreamOn);
    // The stream accepts settings only while it is disabled (section 10.3.17).
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

  /// Bytes that overflow the ring buffer between two calls are lost; the checksum of frames detects
  /// the loss.
  std::size_t read(std::span<std::byte> bytes) noexcept {
    advance();
    std::size_t count = 0;
    while (count < bytes.size() && take(bytes[count])) {  // bound: bytes_size
      ++count;
    }
    return count;
  }

  /// Forgets the bytes that have arrived.
  void discard() noexcept {
    advance();
    next_ = by_dma_ ? written() : 0U;
  }

  /// Accepts nothing while a transfer is in progress.
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
  // Reading the status and then a byte also clears an overrun (section 30.6.1).
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
    if (next_ == written()) {
      return false;
    }
    byte = static_cast<std::byte>(ring_.byte[next_]);
    next_ = (next_ + 1U) % kRingBytes;
    return true;
  }

  [[nodiscard]] std::uint32_t written() const {
    return (kRingBytes - stm32f4::read(dma_.stream[2].ndtr)) % kRingBytes;
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
