#pragma once
// Pins as inputs, outputs and alternate functions (RM0090, sections 8.3 and 8.4).
// Loop and memory annotations: docs/BOUND.md. A register may be as slow as flash.
// memory: RAM

#include <cstdint>

#include "stm32f4/bits.hpp"
#include "stm32f4/registers.hpp"

namespace tactree::firmware::stm32f4 {

enum class PinMode : std::uint32_t { kInput = 0, kOutput = 1, kAlternate = 2 };
enum class Pull : std::uint32_t { kNone = 0, kUp = 1, kDown = 2 };

/// One pin of a port. 0 <= number <= 15.
template <class Word>
class Pin {
 public:
  Pin(GpioBlock<Word>& port, std::uint32_t number) : port_(&port), number_(number) {}

  void make_input(Pull pull) {
    set_pull(pull);
    set_mode(PinMode::kInput);
  }

  /// Configures an output that is low from the start.
  void make_output() {
    drive(false);
    set_mode(PinMode::kOutput);
  }

  /// Configures an alternate function; its number is in the data sheet, table 9.
  void make_alternate(std::uint32_t function, Pull pull) {
    set_pull(pull);
    const std::uint32_t shift = 4U * (number_ % 8U);
    change(number_ < 8U ? port_->afrl : port_->afrh, 0xFU << shift, function << shift);
    set_mode(PinMode::kAlternate);
  }

  /// Changes no other pin: in BSRR, the upper half clears pins and the lower half sets them.
  void drive(bool high) { port_->bsrr = high ? 1U << number_ : 1U << (number_ + 16U); }

  // memory: flash
  [[nodiscard]] bool is_high() const { return has(port_->idr, 1U << number_); }

  /// Reads the mode back. A port without a clock ignores writes and reads as zero.
  [[nodiscard]] bool is(PinMode mode) const {
    // memory: flash
    return ((read(port_->moder) >> (2U * number_)) & 0x3U) == static_cast<std::uint32_t>(mode);
  }

  /// Reads the pull back. Use this for inputs: the mode of an input is zero, which a port without a
  /// clock reads too.
  [[nodiscard]] bool pulls(Pull pull) const {
    // memory: flash
    return ((read(port_->pupdr) >> (2U * number_)) & 0x3U) == static_cast<std::uint32_t>(pull);
  }

 private:
  void set_mode(PinMode mode) { set_field(port_->moder, static_cast<std::uint32_t>(mode)); }
  void set_pull(Pull pull) { set_field(port_->pupdr, static_cast<std::uint32_t>(pull)); }
  void set_field(Word& word, std::uint32_t bits) {
    // memory: flash
    change(word, 0x3U << (2U * number_), bits << (2U * number_));
  }

  GpioBlock<Word>* port_;
  std::uint32_t number_;
};

}  // namespace tactree::firmware::stm32f4
