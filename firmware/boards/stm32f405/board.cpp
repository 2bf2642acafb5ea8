#include "board.hpp"

#include "stm32f4/clocks.hpp"
#include "wiring.hpp"

namespace tactree::firmware {
namespace {

using namespace stm32f4;
using Word = HardwareWord;

// Written before RAM is initialised, so start-up must leave it alone.
[[gnu::section(".noinit")]] ClockFailure clock_failure;

RccBlock<Word>& rcc_block() { return block_at<RccBlock>(address::kRcc); }

Pin<Word> pin_a(std::uint32_t number) { return {block_at<GpioBlock>(address::kGpioA), number}; }
Pin<Word> pin_b(std::uint32_t number) { return {block_at<GpioBlock>(address::kGpioB), number}; }
Pin<Word> pin_c(std::uint32_t number) { return {block_at<GpioBlock>(address::kGpioC), number}; }

QuadratureCounter<Word> counter(std::uint32_t address, CounterWidth width) {
  return {block_at<TimerBlock>(address), width};
}

PwmMotors<Word> pwm_motors() {
  const Pin<Word> direction[] = {pin_c(0), pin_c(1), pin_c(2)};
  return {block_at<TimerBlock>(address::kTim8), direction, pin_b(14), wiring::kEffortAtFullWidth};
}

// A pull-up: an open track does not flutter.
void prepare_encoder_pins() {
  pin_a(15).make_alternate(wiring::kTim2Function, Pull::kUp);
  pin_b(3).make_alternate(wiring::kTim2Function, Pull::kUp);
  pin_a(0).make_alternate(wiring::kTim5Function, Pull::kUp);
  pin_a(1).make_alternate(wiring::kTim5Function, Pull::kUp);
  pin_b(6).make_alternate(wiring::kTim4Function, Pull::kUp);
  pin_b(7).make_alternate(wiring::kTim4Function, Pull::kUp);
}

// A pull-down: no pulse while the timer does not drive, none from a broken failure line.
void prepare_motor_pins() {
  for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
    pin_c(axis).make_output();
    pin_c(6U + axis).make_alternate(wiring::kTim8Function, Pull::kDown);
  }
  pin_b(14).make_input(Pull::kDown);
}

void prepare_link_pins() {
  pin_a(9).make_alternate(wiring::kUsart1Function, Pull::kUp);
  pin_a(10).make_alternate(wiring::kUsart1Function, Pull::kUp);
}

}  // namespace

std::uint32_t timer_clock_hz() {
  return clock_failure == ClockFailure::kNone ? kFullClockHz : kInternalClockHz;
}

void prepare_board() {
  clock_failure =
      start_clocks(rcc_block(), block_at<FlashBlock>(address::kFlash), wiring::kCrystalMHz);
  set(rcc_block().ahb1enr, wiring::kAhb1Clocks);
  set(rcc_block().apb1enr, wiring::kApb1Clocks);
  set(rcc_block().apb2enr, wiring::kApb2Clocks);
  (void)read(rcc_block().apb2enr);  // a part may be used two cycles after its clock is on
}

Stm32f405Board::Stm32f405Board()
    : encoders_(counter(address::kTim2, CounterWidth::k32),
                counter(address::kTim5, CounterWidth::k32),
                counter(address::kTim4, CounterWidth::k16)),
      pwm_(pwm_motors()),
      enable_line_(pin_c(4), pin_c(5), pwm_),
      safety_inputs_(pin_b(12), pin_b(13)),
      port_(block_at<UsartBlock>(address::kUsart1), block_at<DmaBlock>(address::kDma2), ring_),
      link_(port_),
      watchdog_(block_at<WatchdogBlock>(address::kWatchdog)),
      motors_(*this),
      ticker_(*this) {}

core::Configuration Stm32f405Board::connect(const hal::CapturedFault& last_fault) {
  boot_.clocks = clock_failure;
  boot_.reset_by_watchdog = take_watchdog_reset(rcc_block());
  boot_.last_fault = last_fault;
  note(enable_line_.start(), Part::kEnableLine);
  note(safety_inputs_.start(), Part::kSafetyInputs);
  prepare_encoder_pins();
  note(encoders_.start(), Part::kEncoders);
  prepare_motor_pins();
  note(pwm_.start(), Part::kMotors);
  prepare_link_pins();
  port_.start(clock_failure == ClockFailure::kNone ? kApb2Hz : kInternalClockHz, wiring::kBaud);
  return wiring::configuration();
}

// The watchdog starts here and not in connect(): checking a large model takes longer than it waits.
void Stm32f405Board::report(const hal::StartResult& result) {
  boot_.result = result;
  note(watchdog_.start(), Part::kWatchdog);
  link_.tell(boot_);
}

hal::Tick Stm32f405Board::Ticker::wait() noexcept {
  const std::uint32_t missed = deadline_.wait();
  board_.watchdog_.refresh();
  return {missed};
}

bool Stm32f405Board::started() const {
  return boot_.clocks == ClockFailure::kNone && boot_.failed_parts == 0U;
}

void Stm32f405Board::note(bool good, Part part) {
  if (!good) {
    boot_.failed_parts =
        static_cast<std::uint8_t>(boot_.failed_parts | static_cast<unsigned>(part));
  }
}

}  // namespace tactree::firmware
