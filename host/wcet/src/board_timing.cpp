#include <string>
#include <vector>

#include "tactree/wcet/bound.hpp"

namespace tactree::wcet {
namespace {

constexpr const char* kStm32f405 =
    "ST RM0090: program in SRAM; data in flash: 5 wait states, table 10";

const std::vector<BoardTiming>& timings() {
  static const std::vector<BoardTiming> kTimings = {
      // At 168 MHz and 2.7 to 3.6 V the flash has five wait states and reads 128 bits at a time.
      // Its accelerator keeps the 64 most recently used code lines and prefetches the next line
      // while the flash is idle (RM0090, 3.5.2). Its data cache is not modelled. The program is in
      // SRAM1, which has no wait states and is mapped below 112 KiB. If the core fetches code and
      // accesses data in SRAM1 in the same cycle, the bus matrix serves one after the other
      // (RM0090, 2.1), which costs one cycle for each word. The stack is in SRAM2, a separate slave
      // of the bus matrix.
      {"netduinoplus2", 168e6, 5, 16, 64, true, 1, 5, 112 << 10, false, kStm32f405},
      {"stm32f405", 168e6, 5, 16, 64, true, 1, 5, 112 << 10, false, kStm32f405},
      // Prototyping boards: synchronous RAM, one cycle at 25 MHz.
      {"mps2-an386", 25e6, 0, 16, 0, false, 0, 0, 0, true,
       "Arm DAI 0386: 25 MHz; RAM without wait states assumed"},
      {"mps2-an505", 20e6, 0, 16, 0, false, 0, 0, 0, true,
       "Arm DAI 0505: 20 MHz; cycles of a Cortex-M4"},
      {"mps2-an500", 25e6, 0, 16, 0, false, 0, 0, 0, true,
       "Arm DAI 0500: 25 MHz; cycles of a Cortex-M4"},
  };
  return kTimings;
}

}  // namespace

const BoardTiming* find_timing(const std::string& board) {
  for (const BoardTiming& timing : timings()) {
    if (board == timing.board) {
      return &timing;
    }
  }
  return nullptr;
}

}  // namespace tactree::wcet
