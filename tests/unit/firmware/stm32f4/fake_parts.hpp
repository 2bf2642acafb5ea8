#pragma once
// Models of pins, timers, serial port with DMA, and watchdog (RM0090, sections 8, 10, 17, 18, 21
// and 30), as visible to a driver. `tick_us()` advances the time.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fake_word.hpp"
#include "stm32f4/registers.hpp"
#include "stm32f4/serial_port.hpp"

namespace tactree::test {

class FakeGpio {
 public:
  FakeGpio() {
    block.bsrr.on_read = [](std::uint32_t) { return 0U; };
    block.bsrr.on_write = [this](std::uint32_t, std::uint32_t written) {
      // If both are requested, setting has priority.
      block.odr.value = (block.odr.value & ~(written >> 16)) | (written & 0xFFFFU);
      on_output();
      return 0U;
    };
    block.idr.on_read = [this](std::uint32_t) {
      std::uint32_t levels = 0;
      for (std::uint32_t pin = 0; pin < 16; ++pin) {
        levels |= level(pin) ? 1U << pin : 0U;
      }
      return levels;
    };
    block.idr.on_write = [](std::uint32_t value, std::uint32_t) { return value; };
  }

  /// Connection of an input; empty: an open wire.
  void wire(std::uint32_t pin, std::optional<bool> level) { outside_[pin] = level; }
  /// On the wire of a pin.
  [[nodiscard]] bool level(std::uint32_t pin) const {
    if (mode(pin) == 1U) {
      return (block.odr.value & (1U << pin)) != 0U;
    }
    if (outside_[pin].has_value()) {
      return *outside_[pin];
    }
    return ((block.pupdr.value >> (2U * pin)) & 3U) == 1U;
  }
  [[nodiscard]] std::uint32_t mode(std::uint32_t pin) const {
    return (block.moder.value >> (2U * pin)) & 3U;
  }
  [[nodiscard]] std::uint32_t function(std::uint32_t pin) const {
    const FakeWord& word = pin < 8U ? block.afrl : block.afrh;
    return (word.value >> (4U * (pin % 8U))) & 0xFU;
  }
  void gate_by(const std::function<bool()>& clocked) {
    for (FakeWord* word : {&block.moder, &block.otyper, &block.ospeedr, &block.pupdr, &block.idr,
                           &block.odr, &block.bsrr, &block.lckr, &block.afrl, &block.afrh}) {
      gate(*word, clocked);
    }
  }

  firmware::stm32f4::GpioBlock<FakeWord> block;
  std::function<void()> on_output = [] {};  ///< after each change of an output

 private:
  std::optional<bool> outside_[16];
};

class FakeTimer {
 public:
  explicit FakeTimer(std::uint32_t width_mask) : mask_(width_mask) {
    block.arr.value = mask_;
    block.cnt.on_write = [this](std::uint32_t, std::uint32_t written) { return written & mask_; };
    block.arr.on_write = [this](std::uint32_t, std::uint32_t written) { return written & mask_; };
    block.egr.on_read = [](std::uint32_t) { return 0U; };
    block.egr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & 1U) != 0U) {
        take_over();
      }
      return 0U;
    };
  }

  /// The shaft moves this many edges.
  void turn(std::int32_t edges) {
    const bool both_tracks = (block.ccmr1.value & 0x0303U) == 0x0101U;
    const bool counts = (block.cr1.value & 1U) != 0U && (block.smcr.value & 7U) == 3U;
    if (!both_tracks || !counts) {
      return;
    }
    const std::uint64_t period = std::uint64_t{block.arr.value} + 1U;
    const std::int64_t at = static_cast<std::int64_t>(block.cnt.value) + edges;
    const auto signed_period = static_cast<std::int64_t>(period);
    block.cnt.value =
        static_cast<std::uint32_t>(((at % signed_period) + signed_period) % signed_period);
  }

  /// The period ends: buffered compare values take effect.
  void take_over() {
    for (std::uint32_t channel = 0; channel < 3; ++channel) {
      active_[channel] = compare(channel).value;
    }
  }

  /// Share of the time the channel's wire is high, 0 .. 1.
  [[nodiscard]] double duty(std::uint32_t channel) const {
    const bool runs = (block.cr1.value & 1U) != 0U;
    const bool out = (block.bdtr.value & (1U << 15)) != 0U;
    const bool enabled = (block.ccer.value & (1U << (4U * channel))) != 0U;
    const FakeWord& mode = channel < 2U ? block.ccmr1 : block.ccmr2;
    const std::uint32_t bits = mode.value >> (8U * (channel % 2U));
    if (!runs || !out || !enabled || ((bits >> 4) & 7U) != 6U || block.arr.value == 0U) {
      return 0.0;
    }
    const bool buffered = (bits & (1U << 3)) != 0U;
    const std::uint32_t at = buffered ? active_[channel] : compare(channel).value;
    return at >= block.arr.value ? 1.0 : static_cast<double>(at) / block.arr.value;
  }

  /// Outputs are off, and their wires are not held low.
  [[nodiscard]] bool floats() const { return (block.bdtr.value & ((1U << 15) | (1U << 10))) == 0U; }

  void gate_by(const std::function<bool()>& clocked) {
    for (FakeWord* word :
         {&block.cr1, &block.cr2, &block.smcr, &block.egr, &block.ccmr1, &block.ccmr2, &block.ccer,
          &block.cnt, &block.psc, &block.arr, &block.ccr1, &block.ccr2, &block.ccr3, &block.bdtr}) {
      gate(*word, clocked);
    }
  }

  firmware::stm32f4::TimerBlock<FakeWord> block;

 private:
  [[nodiscard]] const FakeWord& compare(std::uint32_t channel) const {
    return channel == 0U ? block.ccr1 : channel == 1U ? block.ccr2 : block.ccr3;
  }

  std::uint32_t mask_;
  std::uint32_t active_[3] = {0, 0, 0};
};

/// USART1 and DMA2 with stream 2.
class FakeSerial {
 public:
  explicit FakeSerial(firmware::stm32f4::Ring* ring) : ring_(ring) {
    usart.sr.on_read = [this](std::uint32_t) {
      return (held_.size() < 2U ? kEmpty : 0U) | (received_.has_value() ? kFull : 0U);
    };
    usart.dr.on_read = [this](std::uint32_t) {
      return std::uint32_t{std::exchange(received_, std::nullopt).value_or(0)};
    };
    usart.dr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((usart.cr1.value & kSends) == kSends) {
        hold(written);
      }
      return 0U;
    };
    auto& stream = dma.stream[2];
    stream.cr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return control(value, written);
    };
    stream.cr.on_read = [this](std::uint32_t value) { return control_read(value); };
    for (FakeWord* word : {&stream.ndtr, &stream.par, &stream.m0ar}) {
      // Settings are taken only while the stream is off.
      word->on_write = [this](std::uint32_t value, std::uint32_t written) {
        return on() ? value : written;
      };
    }
  }

  /// Memory the driver names in M0AR; a test gives the object itself: addresses there have 32 bits.
  void give_ring(firmware::stm32f4::Ring* ring) { ring_ = ring; }

  /// A byte arrives on the wire.
  void arrive(std::uint8_t byte) {
    const bool receives = (usart.cr1.value & kReceives) == kReceives;
    const bool by_dma = (usart.cr3.value & (1U << 6)) != 0U;
    auto& stream = dma.stream[2];
    const bool channel_4 = ((stream.cr.value >> 25) & 7U) == 4U;
    const bool circular = (stream.cr.value & 0x500U) == 0x500U;
    if (!receives) {
      return;
    }
    if (!by_dma) {
      received_ = received_.value_or(byte);  // else it is lost: an overrun
      return;
    }
    if (!on() || !channel_4 || !circular || ring_ == nullptr) {
      return;
    }
    ring_->byte[size_ - stream.ndtr.value] = byte;
    stream.ndtr.value = stream.ndtr.value == 1U ? size_ : stream.ndtr.value - 1U;
  }

  /// Time passes: as many bytes leave as the baud rate allows.
  void tick_us(double us) {
    if (usart.brr.value == 0U) {
      return;
    }
    const double us_per_byte = 10.0 * usart.brr.value / clock_MHz;
    for (time_us_ += us; time_us_ >= us_per_byte && !held_.empty(); time_us_ -= us_per_byte) {
      sent.push_back(held_.front());
      held_.pop_front();
    }
    time_us_ = held_.empty() ? 0.0 : time_us_;
  }

  [[nodiscard]] double baud() const { return clock_MHz * 1e6 / usart.brr.value; }

  void gate_by(const std::function<bool()>& usart_clocked,
               const std::function<bool()>& dma_clocked) {
    for (FakeWord* word : {&usart.sr, &usart.dr, &usart.brr, &usart.cr1, &usart.cr3}) {
      gate(*word, usart_clocked);
    }
    auto& stream = dma.stream[2];
    for (FakeWord* word : {&stream.cr, &stream.ndtr, &stream.par, &stream.m0ar}) {
      gate(*word, dma_clocked);
    }
  }

  double clock_MHz = 84.0;
  std::uint32_t stop_polls = 3;  ///< until a stream that was switched off is off
  std::vector<std::uint8_t> sent;
  std::string violation;
  firmware::stm32f4::UsartBlock<FakeWord> usart;
  firmware::stm32f4::DmaBlock<FakeWord> dma;

 private:
  static constexpr std::uint32_t kFull = 1U << 5;
  static constexpr std::uint32_t kEmpty = 1U << 7;
  static constexpr std::uint32_t kSends = (1U << 13) | (1U << 3);
  static constexpr std::uint32_t kReceives = (1U << 13) | (1U << 2);

  [[nodiscard]] bool on() const { return (dma.stream[2].cr.value & 1U) != 0U; }

  void hold(std::uint32_t byte) {
    if (held_.size() >= 2U) {
      violation = "a byte was written over one that waits";
      held_.pop_back();
    }
    held_.push_back(static_cast<std::uint8_t>(byte));  // one shifts, one waits
  }

  std::uint32_t control(std::uint32_t value, std::uint32_t written) {
    if (on() && (written & 1U) == 0U) {
      stopping_ = stop_polls;
      return value;
    }
    if (on()) {
      return value;
    }
    if ((written & 1U) != 0U) {
      size_ = dma.stream[2].ndtr.value;
    }
    return written;
  }

  std::uint32_t control_read(std::uint32_t value) {
    if (stopping_ > 0U && --stopping_ == 0U) {
      dma.stream[2].cr.value &= ~1U;
      return dma.stream[2].cr.value;
    }
    return value;
  }

  firmware::stm32f4::Ring* ring_;
  std::deque<std::uint8_t> held_;
  std::optional<std::uint8_t> received_;
  double time_us_ = 0.0;
  std::uint32_t size_ = 0;
  std::uint32_t stopping_ = 0;
};

class FakeWatchdog {
 public:
  double oscillator_hz = 32000.0;  ///< 17 000 .. 47 000
  std::uint32_t update_polls = 6;
  bool takes_settings = true;
  bool takes_prescaler = true;

  FakeWatchdog() {
    block.kr.on_read = [](std::uint32_t) { return 0U; };
    block.kr.on_write = [this](std::uint32_t, std::uint32_t key) { return take_key(key); };
    block.rlr.value = 0xFFF;
    block.pr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return takes_prescaler ? set(value, written, updating_[0]) : value;
    };
    block.rlr.on_write = [this](std::uint32_t value, std::uint32_t written) {
      return set(value, written, updating_[1]);
    };
    block.sr.on_read = [this](std::uint32_t) {
      std::uint32_t flags = 0;
      for (std::uint32_t i = 0; i < 2; ++i) {
        updating_[i] -= updating_[i] > 0U ? 1U : 0U;
        flags |= updating_[i] > 0U ? 1U << i : 0U;
      }
      return flags;
    };
  }

  [[nodiscard]] bool runs() const { return runs_; }
  /// Did it reset the chip?
  [[nodiscard]] bool bitten() const { return bitten_; }

  void tick_us(double us) {
    if (!runs_) {
      return;
    }
    left_s_ -= us * 1e-6;
    bitten_ = bitten_ || left_s_ <= 0.0;
  }

 private:
  std::uint32_t set(std::uint32_t value, std::uint32_t written, std::uint32_t& updating) {
    if (!unlocked_ || !takes_settings || updating > 0U) {
      return value;  // ignored while an update is pending
    }
    updating = update_polls;
    return written;
  }

  std::uint32_t take_key(std::uint32_t key) {
    unlocked_ = key == 0x5555U;
    runs_ = runs_ || key == 0xCCCCU;
    if (key == 0xCCCCU || key == 0xAAAAU) {
      left_s_ = (block.rlr.value + 1.0) * static_cast<double>(4U << (block.pr.value & 7U)) /
                oscillator_hz;
    }
    return 0;
  }

 public:
  firmware::stm32f4::WatchdogBlock<FakeWord> block;

 private:
  bool unlocked_ = false;
  bool runs_ = false;
  bool bitten_ = false;
  std::uint32_t updating_[2] = {0, 0};  // prescaler, reload
  double left_s_ = 0.0;
};

}  // namespace tactree::test
