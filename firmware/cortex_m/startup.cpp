// From reset to start_image(): the vector table and the FPU.

#include "cortex_m/registers.hpp"
#include "platform.hpp"
#include "runtime/image.hpp"

namespace tactree::firmware {
namespace {

using Handler = void (*)();

[[noreturn]] void start() {
  cortex_m::coprocessor_access() = cortex_m::coprocessor_access() | cortex_m::kFpuFullAccess;
  cortex_m::handler_control() = cortex_m::handler_control() | cortex_m::kMemoryBusUsageFaults;
  cortex_m::synchronise();
  start_image();
}

}  // namespace
}  // namespace tactree::firmware

extern "C" {
void tactree_fault();
void tactree_deadline();

// What the core reads at reset: stack, then one handler for each exception. An exception nobody
// expects is a fault.
struct VectorTable {
  std::uint32_t* stack_top;
  tactree::firmware::Handler handlers[15];
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable tactree_vectors = {
    image_stack_top,
    {
        tactree::firmware::start,
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
