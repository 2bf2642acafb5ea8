// A firmware with its own start-up, linker script and names. It tests itself, starts a controller
// at two rates, and causes a fault, which the second run reports. Its words go to the emulator's
// terminal.

#include "board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/runtime/admission.hpp"
#include "tactree/runtime/fault_capture.hpp"
#include "tactree/runtime/memory_test.hpp"
#include "tactree/runtime/self_test.hpp"

namespace {

constexpr std::uint32_t kClockHz = 25'000'000;

// Semihosting: SYS_WRITE0 and SYS_EXIT.
void call_host(std::uint32_t operation, std::uint32_t argument) {
  register std::uint32_t r0 __asm("r0") = operation;
  register std::uint32_t r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
void say(const char* words) {
  call_host(0x04, static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(words)));
}

own::Board& board() {
  static own::Board board;
  return board;
}

// Constructed before the first tick: a constructor is no part of a tick, and is not bounded.
tactree::hal::Loop<own::Board>* loop = nullptr;

// What the timer of a real board calls.
[[gnu::noinline]] void control_loop_step() { (void)loop->tick(); }

void start_at(float rate_hz) {
  tactree::core::Configuration configuration;
  configuration.rate_hz = rate_hz;
  const tactree::hal::StartResult started = loop->start(configuration);
  say(started.ok()                                            ? "admitted\n"
      : started.model == tactree::core::ModelStatus::kTooSlow ? "too slow\n"
                                                              : describe(started));
}

bool memory_holds = false;

}  // namespace

extern "C" const tactree::runtime::ImageRecord tactree_image = tactree::runtime::image_record(
    "own", {.clock_hz = kClockHz, .blob_at = own::kModelAddress, .blob_room = own::kModelRoom});

int main() {
  const tactree::hal::CapturedFault fault = tactree::runtime::take_captured_fault();
  if (fault.present()) {
    say(fault.registers[2] == 0x600DCAFE ? "fault recorded\n" : "fault lost\n");
    call_host(0x18, 0x20026);  // the end of an application
  }
  const bool intact = tactree::runtime::test_program() == tactree::hal::ImageStatus::kOk;
  say(intact ? "program intact\n" : "program damaged\n");
  say(memory_holds ? "memory holds\n" : "memory fails\n");
  static tactree::core::Controller controller;
  controller.know_costs(tactree::runtime::tick_costs(), kClockHz);
  static tactree::hal::Loop<own::Board> its_loop(board(), controller);
  loop = &its_loop;
  start_at(20000.0F);
  start_at(500.0F);
  for (int i = 0; i < 10; ++i) {
    control_loop_step();
  }
  say(board().link().state == tactree::core::State::kIdle ? "idle\n" : "not idle\n");
  register std::uint32_t r2 __asm("r2") = 0x600DCAFE;
  __asm volatile("udf #0" ::"r"(r2));
}

extern "C" {
extern std::uint32_t _estack[];
extern std::uint32_t _sdata[];
extern std::uint32_t _edata[];
extern const std::uint32_t _sidata[];
extern std::uint32_t _sbss[];
extern std::uint32_t _ebss[];

[[noreturn, gnu::used]] void Reset_Handler() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) = 0xFU << 20;  // the FPU
  __asm volatile("dsb\n\tisb" ::: "memory");
  const bool holds = tactree::runtime::holds_all_bits(_sdata, _ebss);
  const std::uint32_t* from = _sidata;
  for (std::uint32_t* to = _sdata; to < _edata; ++to) {
    *to = *from++;
  }
  for (std::uint32_t* to = _sbss; to < _ebss; ++to) {
    *to = 0;
  }
  memory_holds = holds;
  main();
  while (true) {
  }
}

struct Vectors {
  std::uint32_t* stack;
  void (*handlers[15])();
};
[[gnu::section(".isr_vector"), gnu::used]] const Vectors kVectors = {
    _estack,
    {Reset_Handler, tactree_fault, tactree_fault, tactree_fault, tactree_fault, tactree_fault}};
}
