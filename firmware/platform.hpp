#pragma once
// What main.cpp and the start-up code want from each other, from the core they run on, and from the
// board. Each function is defined once in an image: one that is missing is an error of the linker.

#include <cstdint>

#include "tactree/core/tick_cost.hpp"
#include "tactree/hal/captured_fault.hpp"

namespace tactree::firmware {

// ---- provided by the core: cortex_m/, rv32/

/// Starts the timer whose interrupt calls tactree_tick(). 100 <= rate_hz <= 20000.
void start_ticks(float rate_hz);
/// Deadlines since start_ticks(); wraps. Safe in the tick and outside it.
[[nodiscard]] std::uint32_t deadlines();
/// Microseconds since start_ticks(), wrapping at 2^32.
[[nodiscard]] std::uint32_t now_us();
/// While held no tick begins; those that fall due meanwhile follow at once. For moments only.
void hold_ticks(bool hold);
/// Sleeps until an interrupt.
void wait_for_interrupt();
/// Starts anew, as after power-up; RAM that is not initialised keeps its content.
[[noreturn]] void reset();

// ---- provided by runtime/

/// Keeps the record and resets. For the fault handlers of a core.
[[noreturn]] void capture(const hal::CapturedFault& fault);
/// What the last run died of; a second call finds nothing.
[[nodiscard]] hal::CapturedFault take_captured_fault();

/// What a tick of this image costs at most.
[[nodiscard]] const core::TickCosts& tick_costs();

// ---- provided by boards/<name>/board.cpp

/// Frequency of the tick timer's clock, Hz; a multiple of 1 MHz. Asked in start_ticks().
[[nodiscard]] std::uint32_t timer_clock_hz();
/// Clocks and pins; before main(), with nothing initialised yet.
void prepare_board();

}  // namespace tactree::firmware

extern "C" {
/// One tick of the control loop, in the context of an interrupt of low priority.
void tactree_tick();
/// Sleeps for ever, between the ticks. Of the core: the instruction counter takes a tick as over
/// when the core is in here.
[[noreturn]] void tactree_idle();
int main();
}
