// A defective board, to be detected by the host: built with TACTREE_SILENT it sends no hello;
// otherwise it faults in its third tick.

#include "board.hpp"
#include "platform.hpp"

namespace {
tactree::firmware::Board board;
int ticks = 0;
}  // namespace

void tactree_tick() {
  (void)board.ticker().wait();
  if (++ticks == 3) {
    __builtin_trap();
  }
}

int main() {
#if !defined(TACTREE_SILENT)
  const auto configuration = board.connect(tactree::firmware::take_captured_fault());
  board.report({});
  tactree::firmware::start_ticks(configuration.rate_hz);
#endif
  tactree_idle();
}
