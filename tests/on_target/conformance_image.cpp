// The conformance program on a board. It ends the emulation with its verdict.

#include "board.hpp"
#include "plant_link/semihosting.hpp"
#include "tactree/hal/conformance.hpp"

void tactree_tick() {}

int main() {
  using namespace tactree;
  static firmware::Board board;
  const core::Configuration configuration = board.connect(firmware::take_captured_fault());
  board.report({});
  firmware::start_ticks(configuration.rate_hz);
  hal::ConformanceSetup setup;
  setup.period_us = static_cast<std::uint32_t>(1e6F / configuration.rate_hz + 0.5F);
  const hal::ConformanceReport report = hal::run_conformance(board, setup);
  for (std::uint32_t i = 0; i < report.failures && i < hal::ConformanceReport::kMaxFailures; ++i) {
    firmware::semihosting::print(report.failed[i]);
    firmware::semihosting::print("\n");
  }
  firmware::semihosting::print(report.passed() ? "conformance passed\n" : "conformance failed\n");
  firmware::semihosting::exit(report.passed() ? 0 : 1);
}
