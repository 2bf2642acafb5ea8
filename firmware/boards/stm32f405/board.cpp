#include "board.hpp"

#include "runtime/identity.hpp"
#include "stm32f4/program_in_ram.hpp"

namespace tactree::firmware {
namespace {

// prepare_board() writes this before RAM is initialised; start-up must not clear it.
[[gnu::section(".noinit")]] stm32f4::ClockFailure clock_failure;

}  // namespace

std::uint32_t timer_clock_hz() {
  return clock_failure == stm32f4::ClockFailure::kNone ? stm32f4::kFullClockHz
                                                       : stm32f4::kInternalClockHz;
}

void prepare_board() { clock_failure = prepare_chip(stm32f4::this_chip()); }

Board::Board()
    : Stm32f405Board(stm32f4::this_chip(), stm32f4::flash_cells(), clock_failure,
                     {kIdentity.board, TACTREE_FIRMWARE_VERSION, {}, timer_clock_hz()}) {}

core::Configuration Board::connect(const hal::CapturedFault& last_fault) {
  return Stm32f405Board::connect(last_fault);
}

void Board::serve(core::Controller& controller, const hal::StartResult& started,
                  const core::Configuration& configuration) {
  Stm32f405Board::serve(controller, started, configuration);
}

}  // namespace tactree::firmware
