#include "board.hpp"

#include "cortex_m/registers.hpp"

namespace tactree::firmware {
namespace {

using stm32f4::block_at;

// Of the internal oscillator, which runs after a reset (RM0433, 8.5.2). No step of a start can
// fail.
constexpr std::uint32_t kClockHz = 64'000'000;

// Reset and clock control (RM0433, 8.7): enabled blocks.
constexpr std::uint32_t kAhb4Enr = 0x580244E0;   // GPIO A, B, C
constexpr std::uint32_t kApb1lEnr = 0x580244E8;  // TIM2, TIM4, TIM5
constexpr std::uint32_t kApb2Enr = 0x580244F0;   // TIM8
constexpr std::uint32_t kGpioA = 0x58020000;
constexpr std::uint32_t kGpioB = 0x58020400;
constexpr std::uint32_t kGpioC = 0x58020800;
constexpr std::uint32_t kWatchdog = 0x58004800;

// Instruction cache of the Cortex-M7 (Armv7-M Architecture Reference Manual, B2.2).
constexpr std::uint32_t kInvalidateInstructions = 0xE000EF50;
constexpr std::uint32_t kConfiguration = 0xE000ED14;
constexpr std::uint32_t kInstructionCache = 1U << 17;

void enable(std::uint32_t address, std::uint32_t blocks) {
  cortex_m::register_at(address) = cortex_m::register_at(address) | blocks;
  [[maybe_unused]] const std::uint32_t enabled = cortex_m::register_at(address);  // takes effect
}

stm32f4::StandAloneChip<stm32f4::HardwareWord> this_chip() {
  using stm32f4::GpioBlock;
  using stm32f4::TimerBlock;
  namespace address = stm32f4::address;  // the timers have those of the STM32F405
  return {block_at<GpioBlock>(kGpioA),          block_at<GpioBlock>(kGpioB),
          block_at<GpioBlock>(kGpioC),          block_at<TimerBlock>(address::kTim2),
          block_at<TimerBlock>(address::kTim4), block_at<TimerBlock>(address::kTim5),
          block_at<TimerBlock>(address::kTim8), block_at<stm32f4::WatchdogBlock>(kWatchdog)};
}

}  // namespace

std::uint32_t timer_clock_hz() { return kClockHz; }

void prepare_board() {
  cortex_m::synchronise();
  cortex_m::register_at(kInvalidateInstructions) = 0;
  cortex_m::synchronise();
  cortex_m::register_at(kConfiguration) = cortex_m::register_at(kConfiguration) | kInstructionCache;
  cortex_m::synchronise();
  enable(kAhb4Enr, 0x7U);
  enable(kApb1lEnr, (1U << 0) | (1U << 2) | (1U << 3));
  enable(kApb2Enr, 1U << 1);
}

Board::Board() : StandAloneBoard(this_chip(), wiring::kEffortAtFullWidth) {}

}  // namespace tactree::firmware
