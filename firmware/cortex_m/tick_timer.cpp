// SysTick has the highest priority, counts the deadlines and requests PendSV, which has the lowest
// priority and runs the tick. SysTick interrupts a late tick, so no deadline is lost.
// Loop and memory annotations: docs/BOUND.md.

#include "cortex_m/registers.hpp"
#include "platform.hpp"

namespace tactree::firmware {
namespace {

constexpr std::uint32_t kMegahertz = 1000000;

volatile std::uint32_t counted = 0;
std::uint32_t period_cycles = 0;
std::uint32_t period_us = 0;
std::uint32_t cycles_per_us = 1;

}  // namespace

void start_ticks(float rate_hz) {
  period_cycles = static_cast<std::uint32_t>(static_cast<float>(timer_clock_hz()) / rate_hz + 0.5F);
  cycles_per_us = timer_clock_hz() / kMegahertz;
  period_us = period_cycles / cycles_per_us;
  cortex_m::handler_priority_3() = cortex_m::kPendsvLowest;
  cortex_m::systick_reload() = period_cycles - 1U;
  cortex_m::systick_value() = 0;  // any write clears it
  cortex_m::systick_control() = cortex_m::kSystickOn;
}

std::uint32_t deadlines() { return counted; }

// Reads again if a deadline has passed between the two reads.
std::uint32_t now_us() {
  std::uint32_t before;
  std::uint32_t cycles;
  do {  // bound: 2
    before = counted;
    cycles = period_cycles - 1U - cortex_m::systick_value();
  } while (before != counted);
  return before * period_us + cycles / cycles_per_us;
}

void hold_ticks(bool hold) {
  if (hold) {
    __asm volatile("cpsid i" ::: "memory");
  } else {
    __asm volatile("cpsie i" ::: "memory");
  }
}

void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

}  // namespace tactree::firmware

extern "C" {

void tactree_deadline();
void tactree_deadline() {
  tactree::firmware::counted = tactree::firmware::counted + 1U;
  tactree::firmware::cortex_m::interrupt_control() = tactree::firmware::cortex_m::kPendPendsv;
}

void tactree_idle() {
  while (true) {  // bound: for_ever
    __asm volatile("wfi" ::: "memory");
  }
}
}
