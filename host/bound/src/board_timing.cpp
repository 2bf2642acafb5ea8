#include <string>

#include "tactree/bound/bound.hpp"

namespace tactree::bound {
namespace {

constexpr BoardTiming kTimings[] = {
    // At 168 MHz and 2.7 to 3.6 V the flash wants five wait states and gives 128 bits at a time.
    // Its accelerator keeps the 64 lines that were used last, and fetches the next line ahead where
    // nothing else wants the flash (RM0090, 3.5.2); its cache of data is left out. A datum is in
    // flash but where the source says that it is not.
    {"netduinoplus2", 168e6, 5, 16, 64, true, 0, 5, false, "ST RM0090, table 10: 5 wait states"},
    {"stm32f405", 168e6, 5, 16, 64, true, 0, 5, false, "ST RM0090, table 10: 5 wait states"},
    // Prototyping boards: synchronous RAM, one cycle as the core sees it at 25 MHz.
    {"mps2-an386", 25e6, 0, 16, 0, false, 0, 0, true,
     "Arm DAI 0386: 25 MHz; RAM without wait states assumed"},
    {"mps2-an505", 20e6, 0, 16, 0, false, 0, 0, true,
     "Arm DAI 0505: 20 MHz; figures of a Cortex-M4"},
    {"mps2-an500", 25e6, 0, 16, 0, false, 0, 0, true,
     "Arm DAI 0500: 25 MHz; figures of a Cortex-M4"},
};

}  // namespace

const BoardTiming* find_timing(const std::string& board) {
  for (const BoardTiming& timing : kTimings) {
    if (board == timing.board) {
      return &timing;
    }
  }
  return nullptr;
}

}  // namespace tactree::bound
