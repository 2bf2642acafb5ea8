#pragma once
// A whole STM32F405 on the board of firmware/boards/stm32f405: parts without a clock are dead, the
// amplifiers follow the enable line, a device turns the encoders. `tick()` lets a millisecond pass.

#include <cstdint>

#include "fake_clocks.hpp"
#include "fake_flash.hpp"
#include "fake_parts.hpp"
#include "fake_usb_otg.hpp"

namespace tactree::test {

class FakeChip {
 public:
  FakeChip() : clocks(flash.block), serial(nullptr) {
    const auto clocked = [](const FakeWord& word, std::uint32_t bit) {
      return [&word, bit] { return (word.value & (1U << bit)) != 0U; };
    };
    gpio_a.gate_by(clocked(clocks.rcc.ahb1enr, 0));
    gpio_b.gate_by(clocked(clocks.rcc.ahb1enr, 1));
    gpio_c.gate_by(clocked(clocks.rcc.ahb1enr, 2));
    tim2.gate_by(clocked(clocks.rcc.apb1enr, 0));
    tim4.gate_by(clocked(clocks.rcc.apb1enr, 2));
    tim5.gate_by(clocked(clocks.rcc.apb1enr, 3));
    tim8.gate_by(clocked(clocks.rcc.apb2enr, 1));
    serial.gate_by(clocked(clocks.rcc.apb2enr, 4), clocked(clocks.rcc.ahb1enr, 22));
    usb.gate_by(clocked(clocks.rcc.ahb2enr, 7));
    gpio_b.wire(12, false);  // emergency stop: closed to ground
    gpio_b.wire(14, true);   // amplifiers are good
    gpio_c.wire(5, false);   // amplifiers have no power
    flash.pass = [this](double us) { pass_us(us); };
  }

  [[nodiscard]] firmware::stm32f4::Chip<FakeWord> chip() {
    return {clocks.rcc,   flash.block, gpio_a.block,   gpio_b.block, gpio_c.block,
            tim2.block,   tim4.block,  tim5.block,     tim8.block,   clocks.tim11,
            serial.usart, serial.dma,  watchdog.block, usb.block,    unique_id};
  }

  void tick() {
    pass_us(1000);
    begin_tick();
  }
  /// The deadline of the next tick.
  void begin_tick() {
    ++ticks;
    if (power_follows) {
      gpio_c.wire(5, gpio_c.level(4));
    }
    tim8.take_over();
  }
  void pass_us(double us) {
    serial.clock_MHz = clocks.apb2_MHz();
    serial.tick_us(us);
    watchdog.tick_us(us);
  }

  /// A switch of the device.
  void press_stop(bool pressed) { press(12, !pressed); }
  void hold_dead_man(bool held) { press(13, held); }
  void press_button(bool pressed) { press(15, pressed); }
  void turn(std::int32_t x, std::int32_t y, std::int32_t z) {
    tim2.turn(x);
    tim5.turn(y);
    tim4.turn(z);
  }

  FakeFlash flash{FakeFlash::whole_chip(), 0xFFFFFFFFU};
  FakeClocks clocks;
  FakeGpio gpio_a, gpio_b, gpio_c;
  FakeTimer tim2{0xFFFFFFFFU}, tim4{0xFFFFU}, tim5{0xFFFFFFFFU}, tim8{0xFFFFU};
  FakeSerial serial;
  FakeWatchdog watchdog;
  FakeUsbOtg usb;
  firmware::stm32f4::UniqueIdBlock<FakeWord> unique_id;
  std::uint32_t ticks = 0;
  bool power_follows = true;

 private:
  // Closed to ground, or open.
  void press(std::uint32_t pin, bool closed) {
    gpio_b.wire(pin, closed ? std::optional<bool>(false) : std::nullopt);
  }
};

}  // namespace tactree::test
