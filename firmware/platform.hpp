#pragma once
// Interfaces between main.cpp, the start-up code, the processor core and the board. Each function
// must be defined once in an image; a missing definition is a linker error.

#include <cstdint>

#include "tactree/runtime/admission.hpp"
#include "tactree/runtime/fault_capture.hpp"

namespace tactree::firmware {

// ---- provided by the core: cortex_m/, rv32/

/// Starts the timer whose interrupt calls tactree_tick(). Precondition: 100 <= rate_hz <= 20000.
void start_ticks(float rate_hz);
/// Number of deadlines since start_ticks(), modulo 2^32. Safe in the tick and outside it.
[[nodiscard]] std::uint32_t deadlines();
/// Microseconds since start_ticks(), modulo 2^32. Do not call while ticks are held: a deadline that
/// passes then is not counted on a Cortex-M, so the time would step back by one period.
[[nodiscard]] std::uint32_t now_us();
/// While ticks are held, none begins; a tick that became due begins when they are released. Hold
/// ticks only briefly.
void hold_ticks(bool hold);
/// Sleeps until the next interrupt.
void wait_for_interrupt();
// ---- provided by hal/runtime: record of a fault, costs of a tick

using runtime::capture;
using runtime::reset;
using runtime::take_captured_fault;
using runtime::tick_costs;

// ---- provided by boards/<name>/board.cpp

/// Clock frequency of the tick timer, Hz; a multiple of 1 MHz. Called by start_ticks().
[[nodiscard]] std::uint32_t timer_clock_hz();
/// Sets up clocks and pins. Runs before main(); variables are not initialised yet.
void prepare_board();

}  // namespace tactree::firmware

extern "C" {
/// One tick of the control loop, in the context of an interrupt of low priority.
void tactree_tick();
/// Sleeps between the ticks and does not return. Provided by the core: the instruction counter
/// recognises the end of a tick by entry into this function.
[[noreturn]] void tactree_idle();
int main();
}
