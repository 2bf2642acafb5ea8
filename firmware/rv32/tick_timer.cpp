// The machine timer runs freely; its compare register holds the next deadline. After a late tick
// the number of missed deadlines is computed from the time.
// Loop and memory annotations: docs/BOUND.md.

#include "platform.hpp"
#include "rv32/registers.hpp"

namespace tactree::firmware {
namespace {

constexpr std::uint32_t kMegahertz = 1000000;

std::uint32_t period = 0;  // timer clocks
std::uint32_t period_us = 0;
std::uint32_t cycles_per_us = 1;
volatile std::uint32_t counted = 0;
volatile std::uint32_t last_deadline = 0;  // low word of the time of the last deadline

// Sets the high word to its maximum first, which prevents an interrupt between the other two
// writes.
void set_next_deadline(std::uint32_t low) {
  std::uint32_t high = rv32::timer_high();
  high += low < rv32::timer_low() ? 1U : 0U;
  rv32::timer_compare_high() = 0xFFFFFFFFU;
  rv32::timer_compare_low() = low;
  rv32::timer_compare_high() = high;
}

// Counts all deadlines that have passed, also those that passed during a tick.
void count_deadlines() {
  const std::uint32_t passed = (rv32::timer_low() - last_deadline) / period;
  last_deadline = last_deadline + passed * period;
  counted = counted + passed;
}

}  // namespace

void start_ticks(float rate_hz) {
  period = static_cast<std::uint32_t>(static_cast<float>(timer_clock_hz()) / rate_hz + 0.5F);
  cycles_per_us = timer_clock_hz() / kMegahertz;
  period_us = period / cycles_per_us;
  last_deadline = rv32::timer_low();
  set_next_deadline(last_deadline + period);
  __asm volatile("csrs mie, %0" ::"r"(rv32::kTimerInterrupt));
  __asm volatile("csrs mstatus, %0" ::"r"(rv32::kStatusInterrupts));
}

std::uint32_t deadlines() { return counted; }

std::uint32_t now_us() {
  std::uint32_t before;
  std::uint32_t cycles;
  do {  // bound: 2
    before = counted;
    cycles = rv32::timer_low() - last_deadline;
  } while (before != counted);
  return before * period_us + cycles / cycles_per_us;
}

void hold_ticks(bool hold) {
  if (hold) {
    __asm volatile("csrc mstatus, %0" ::"r"(rv32::kStatusInterrupts) : "memory");
  } else {
    __asm volatile("csrs mstatus, %0" ::"r"(rv32::kStatusInterrupts) : "memory");
  }
}

void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

}  // namespace tactree::firmware

extern "C" {
// The next deadline is set before the tick runs. Interrupts are disabled during the tick.
[[gnu::interrupt("machine"), gnu::used]] void tactree_timer_interrupt() {
  using namespace tactree::firmware;
  count_deadlines();
  set_next_deadline(last_deadline + period);
  tactree_tick();
}

void tactree_idle() {
  while (true) {  // bound: for_ever
    __asm volatile("wfi" ::: "memory");
  }
}
}
