// Does the HC-3 keep the contracts? To be run on the board, before any motor is connected; look at
// `report` with a debugger.

#include "tactree/hal/conformance.hpp"

#include "hc3_board.hpp"

tactree::hal::ConformanceReport report;

int main() {
  static hc3::Board board;
  report = tactree::hal::run_conformance(board);
  return report.passed() ? 0 : 1;
}
