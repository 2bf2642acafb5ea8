// Sectors of the chip as a flash for models; an erase halts the board first.

#include "stm32f4/store_flash.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "fake_flash.hpp"

namespace tactree::test {
namespace {

struct FakeStandstill {
  bool can = true;
  int begun = 0;
  int ended = 0;
  [[nodiscard]] bool begin() noexcept {
    ++begun;
    return can;
  }
  void end() noexcept { ++ended; }
};

using StoreFlash = firmware::stm32f4::StoreFlash<FakeWord, FakeCell, FakeStandstill>;
static_assert(hal::Flash<StoreFlash>);

class StoreFlashTest : public testing::Test {
 protected:
  ~StoreFlashTest() override { EXPECT_EQ(whole.violation, ""); }
  FakeFlash whole{FakeFlash::whole_chip(), 0U};
  FakeStandstill standstill;
  StoreFlash flash{whole.block, whole.whole(), {6, 6, 32768}, standstill};
};

TEST_F(StoreFlashTest, ExposesBytesOfSectors) {
  const StoreFlash records(whole.block, whole.whole(), {1, 2, 4096}, standstill);
  EXPECT_EQ(records.geometry().sector_bytes, 16384U);
  EXPECT_EQ(records.bytes().size(), 32768U);
  EXPECT_EQ(records.bytes().data() - whole.whole().bytes, 0x4000);
  EXPECT_EQ(flash.geometry().sector_bytes, 131072U);
  EXPECT_EQ(flash.bytes().data() - whole.whole().bytes, 0x40000);
  EXPECT_EQ(flash.bytes().data() + flash.bytes().size() - whole.whole().bytes, 0x100000);
}

TEST_F(StoreFlashTest, ProgramsAndReadsInPlace) {
  ASSERT_TRUE(flash.erase(1));
  standstill = {};
  std::array<std::byte, 200> piece{};
  for (std::size_t i = 0; i < piece.size(); ++i) {
    piece[i] = static_cast<std::byte>(i);
  }
  ASSERT_TRUE(flash.program(131072U + 8U, piece));
  EXPECT_EQ(std::memcmp(flash.bytes().data() + 131072 + 8, piece.data(), piece.size()), 0);
  EXPECT_EQ(standstill.begun, 0) << "a word does not stop the ticks";
  EXPECT_FALSE(flash.program(2, std::span(piece).first(4)));
  EXPECT_FALSE(flash.program(4, std::span(piece).first(3)));
  EXPECT_FALSE(flash.program(6U * 131072U - 4U, std::span(piece).first(8)));
  EXPECT_FALSE(flash.program(131072U + 8U, std::span(piece).subspan(4, 8)))
      << "it was written before";
}

TEST_F(StoreFlashTest, ErasesOnHaltedBoard) {
  whole.pass = [&](double) {
    EXPECT_EQ(standstill.begun, 1);
    EXPECT_EQ(standstill.ended, 0);
  };
  EXPECT_TRUE(flash.erase(1));
  EXPECT_EQ(standstill.ended, 1);
  EXPECT_EQ(whole.erased, 1U);
  EXPECT_EQ(flash.bytes()[131072], std::byte{0xFF});
  EXPECT_EQ(flash.bytes()[131071], std::byte{0});
}

TEST_F(StoreFlashTest, RefusesEraseWithoutHalt) {
  standstill.can = false;
  EXPECT_FALSE(flash.erase(1));
  EXPECT_EQ(whole.operations, 0U);
  EXPECT_EQ(standstill.ended, 1) << "what was begun is not put back";
}

}  // namespace
}  // namespace tactree::test
