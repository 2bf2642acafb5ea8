#pragma once
// Register blocks of an STM32F405 that its drivers use, from ST's reference manual RM0090. `Word`
// is `volatile std::uint32_t` on the chip and a simulated register in tests. Drivers receive their
// blocks by reference, so the same code runs on both.

#include <cstddef>
#include <cstdint>

namespace tactree::firmware::stm32f4 {

using HardwareWord = volatile std::uint32_t;

/// Reset and clock control: section 7.3.
template <class Word>
struct RccBlock {
  Word cr, pllcfgr, cfgr, cir;
  Word ahb1rstr, ahb2rstr, ahb3rstr, reserved_0, apb1rstr, apb2rstr, reserved_1[2];
  Word ahb1enr, ahb2enr, ahb3enr, reserved_2, apb1enr, apb2enr, reserved_3[2];
  Word ahb1lpenr, ahb2lpenr, ahb3lpenr, reserved_4, apb1lpenr, apb2lpenr, reserved_5[2];
  Word bdcr, csr;
};

/// Flash interface: section 3.9.
template <class Word>
struct FlashBlock {
  Word acr, keyr, optkeyr, sr, cr, optcr;
};

/// Port of 16 pins: section 8.4.
template <class Word>
struct GpioBlock {
  Word moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afrl, afrh;
};

/// Timer: section 17.4 (TIM1 and TIM8), 18.4 (TIM2 to TIM5, which have no rcr and bdtr), 19.5
/// (TIM11, which has one channel).
template <class Word>
struct TimerBlock {
  Word cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, rcr;
  Word ccr1, ccr2, ccr3, ccr4, bdtr, dcr, dmar, option;
};

/// Serial port: section 30.6.
template <class Word>
struct UsartBlock {
  Word sr, dr, brr, cr1, cr2, cr3, gtpr;
};

/// DMA controller: section 10.5, with the first four of its eight streams.
template <class Word>
struct DmaBlock {
  struct Stream {
    Word cr, ndtr, par, m0ar, m1ar, fcr;
  };
  Word lisr, hisr, lifcr, hifcr;
  Stream stream[4];
};

/// Independent watchdog: section 21.4.
template <class Word>
struct WatchdogBlock {
  Word kr, pr, rlr, sr;
};

/// USB on-the-go full-speed, as a device: section 34.16.
template <class Word>
struct OtgFsBlock {
  struct Endpoint {
    Word ctl, reserved_0, intr, reserved_1, tsiz, reserved_2, txfsts, reserved_3;
  };
  /// Every word of the 4 KiB is the same port.
  struct Fifo {
    Word word, same[1023];
  };
  Word gotgctl, gotgint, gahbcfg, gusbcfg, grstctl, gintsts, gintmsk, grxstsr, grxstsp, grxfsiz;
  Word dieptxf0, hnptxsts, reserved_0[2], gccfg, cid, reserved_1[48], hptxfsiz, dieptxf[3];
  Word reserved_2[444], dcfg, dctl, dsts, reserved_3, diepmsk, doepmsk, daint, daintmsk;
  Word reserved_4[2], dvbusdis, dvbuspulse, reserved_5, diepempmsk, reserved_6[50];
  Endpoint in[4];
  Word reserved_7[96];
  Endpoint out[4];
  Word reserved_8[160], pcgcctl, reserved_9[127];
  Fifo fifo[4];
};

/// Unique number of the chip, 96 bits: section 39.1.
template <class Word>
struct UniqueIdBlock {
  Word word[3];
};

static_assert(offsetof(RccBlock<HardwareWord>, apb1rstr) == 0x20);
static_assert(offsetof(RccBlock<HardwareWord>, ahb1enr) == 0x30);
static_assert(offsetof(RccBlock<HardwareWord>, apb2enr) == 0x44);
static_assert(offsetof(RccBlock<HardwareWord>, csr) == 0x74);
static_assert(offsetof(FlashBlock<HardwareWord>, cr) == 0x10);
static_assert(offsetof(GpioBlock<HardwareWord>, afrh) == 0x24);
static_assert(offsetof(TimerBlock<HardwareWord>, cnt) == 0x24);
static_assert(offsetof(TimerBlock<HardwareWord>, bdtr) == 0x44);
static_assert(offsetof(TimerBlock<HardwareWord>, option) == 0x50);
static_assert(offsetof(UsartBlock<HardwareWord>, cr3) == 0x14);
static_assert(offsetof(DmaBlock<HardwareWord>, stream) + 2 * 0x18 == 0x40);
static_assert(offsetof(WatchdogBlock<HardwareWord>, sr) == 0x0C);
static_assert(offsetof(OtgFsBlock<HardwareWord>, gccfg) == 0x38);
static_assert(offsetof(OtgFsBlock<HardwareWord>, dieptxf) == 0x104);
static_assert(offsetof(OtgFsBlock<HardwareWord>, dcfg) == 0x800);
static_assert(offsetof(OtgFsBlock<HardwareWord>, diepempmsk) == 0x834);
static_assert(offsetof(OtgFsBlock<HardwareWord>, in) == 0x900);
static_assert(offsetof(OtgFsBlock<HardwareWord>, out) == 0xB00);
static_assert(offsetof(OtgFsBlock<HardwareWord>, pcgcctl) == 0xE00);
static_assert(offsetof(OtgFsBlock<HardwareWord>, fifo) == 0x1000);
static_assert(sizeof(OtgFsBlock<HardwareWord>::Endpoint) == 0x20);
static_assert(sizeof(OtgFsBlock<HardwareWord>::Fifo) == 0x1000);

/// Addresses of the blocks: section 2.3, table 1.
namespace address {
inline constexpr std::uint32_t kFlashBegin = 0x08000000;
inline constexpr std::uint32_t kUniqueId = 0x1FFF7A10;
inline constexpr std::uint32_t kTim2 = 0x40000000;
inline constexpr std::uint32_t kTim4 = 0x40000800;
inline constexpr std::uint32_t kTim5 = 0x40000C00;
inline constexpr std::uint32_t kWatchdog = 0x40003000;
inline constexpr std::uint32_t kTim8 = 0x40010400;
inline constexpr std::uint32_t kUsart1 = 0x40011000;
inline constexpr std::uint32_t kTim11 = 0x40014800;
inline constexpr std::uint32_t kGpioA = 0x40020000;
inline constexpr std::uint32_t kGpioB = 0x40020400;
inline constexpr std::uint32_t kGpioC = 0x40020800;
inline constexpr std::uint32_t kRcc = 0x40023800;
inline constexpr std::uint32_t kFlash = 0x40023C00;
inline constexpr std::uint32_t kDma2 = 0x40026400;
inline constexpr std::uint32_t kOtgFs = 0x50000000;
}  // namespace address

/// The block at an address of the chip.
template <template <class> class Block>
Block<HardwareWord>& block_at(std::uint32_t address) {
  return *reinterpret_cast<Block<HardwareWord>*>(static_cast<std::uintptr_t>(address));
}

/// All blocks in use.
template <class Word>
struct Chip {
  RccBlock<Word>& rcc;
  FlashBlock<Word>& flash;
  GpioBlock<Word>& gpio_a;
  GpioBlock<Word>& gpio_b;
  GpioBlock<Word>& gpio_c;
  TimerBlock<Word>& tim2;
  TimerBlock<Word>& tim4;
  TimerBlock<Word>& tim5;
  TimerBlock<Word>& tim8;
  TimerBlock<Word>& tim11;
  UsartBlock<Word>& usart1;
  DmaBlock<Word>& dma2;
  WatchdogBlock<Word>& watchdog;
  OtgFsBlock<Word>& otg_fs;
  UniqueIdBlock<Word>& unique_id;
};

/// The chip this program runs on.
inline Chip<HardwareWord> this_chip() {
  return {block_at<RccBlock>(address::kRcc),           block_at<FlashBlock>(address::kFlash),
          block_at<GpioBlock>(address::kGpioA),        block_at<GpioBlock>(address::kGpioB),
          block_at<GpioBlock>(address::kGpioC),        block_at<TimerBlock>(address::kTim2),
          block_at<TimerBlock>(address::kTim4),        block_at<TimerBlock>(address::kTim5),
          block_at<TimerBlock>(address::kTim8),        block_at<TimerBlock>(address::kTim11),
          block_at<UsartBlock>(address::kUsart1),      block_at<DmaBlock>(address::kDma2),
          block_at<WatchdogBlock>(address::kWatchdog), block_at<OtgFsBlock>(address::kOtgFs),
          block_at<UniqueIdBlock>(address::kUniqueId)};
}

}  // namespace tactree::firmware::stm32f4
