// Start-up from reset to start_image(): vector table, FPU and fault exceptions.

#include "cortex_m/registers.hpp"
#include "platform.hpp"
#include "runtime/image.hpp"

namespace tactree::firmware {
namespace {

using Handler = void (*)();

}  // namespace
}  // namespace tactree::firmware

extern "C" {
[[noreturn, gnu::used]] void tactree_start() {
  namespace core = tactree::firmware::cortex_m;
  core::coprocessor_access() = core::coprocessor_access() | core::kFpuFullAccess;
  core::handler_control() = core::handler_control() | core::kMemoryBusUsageFaults;
  core::synchronise();
  tactree::firmware::start_image();
}

// A board may define its own reset handler, which must end with a call of tactree_start().
[[noreturn, gnu::weak, gnu::alias("tactree_start")]] void tactree_reset();

void tactree_fault();
void tactree_deadline();

// The vector table: initial stack pointer, then one handler per exception. Unused exceptions are
// handled as faults.
struct VectorTable {
  std::uint32_t* stack_top;
  tactree::firmware::Handler handlers[15];
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable kVectors = {
    image_stack_top,
    {
        tactree_reset,
        tactree_fault,  // NMI
        tactree_fault,  // hard fault
        tactree_fault,  // memory management
        tactree_fault,  // bus
        tactree_fault,  // usage
        tactree_fault,  // secure (Armv8-M)
        tactree_fault, tactree_fault, tactree_fault,
        tactree_fault,  // supervisor call
        tactree_fault,  // debug monitor
        tactree_fault,
        tactree_tick,      // PendSV, lowest priority
        tactree_deadline,  // SysTick, highest priority
    },
};
}
