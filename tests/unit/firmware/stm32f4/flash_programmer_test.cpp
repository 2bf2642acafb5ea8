// Erasing and programming, and every refusal of the flash.

#include "stm32f4/flash_programmer.hpp"

#include <gtest/gtest.h>

#include "fake_flash.hpp"

namespace tactree::test {
namespace {

using firmware::stm32f4::FlashProgrammer;
using firmware::stm32f4::FlashStatus;

constexpr std::uint32_t kWords[] = {0x54434154, 0, 0xFFFFFFFF, 0x12345678};

class Flash : public testing::Test {
 protected:
  FlashProgrammer<FakeWord, FakeCell> programmer() {
    return {fake.block, fake.cells(), fake.region, {100, 10}};
  }
  ~Flash() override { EXPECT_EQ(fake.violation, ""); }
  FakeFlash fake;
};

TEST_F(Flash, ErasesAndProgramsOneSector) {
  auto flash = programmer();
  EXPECT_EQ(flash.erase(1), FlashStatus::kOk);
  EXPECT_EQ(flash.program(FakeFlash::kWords + 2, kWords), FlashStatus::kOk);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_EQ(fake.stored(FakeFlash::kWords + 2 + i), kWords[i]);
  }
  EXPECT_EQ(fake.stored(FakeFlash::kWords + 1), 0xFFFFFFFFU);
  EXPECT_EQ(fake.stored(FakeFlash::kWords - 1), 0U) << "the sector before was touched";
  EXPECT_EQ(fake.stored(2 * FakeFlash::kWords), 0U) << "the sector after was touched";
  EXPECT_TRUE(fake.locked());
  EXPECT_EQ(fake.operations, 5U);
}

TEST_F(Flash, BypassesStaleCache) {
  EXPECT_EQ(std::uint32_t{fake.cells()[0]}, 0U);  // now it is in the cache
  EXPECT_EQ(programmer().erase(0), FlashStatus::kOk);
  EXPECT_EQ(programmer().program(0, kWords), FlashStatus::kOk);
  EXPECT_EQ(std::uint32_t{fake.cells()[0]}, kWords[0]);
  EXPECT_NE(fake.block.acr.value & (1U << 10), 0U) << "the cache stayed off";
}

TEST_F(Flash, WritesNothingOutsideRegion) {
  auto flash = programmer();
  EXPECT_EQ(flash.erase(FakeFlash::kSectors), FlashStatus::kOutside);
  EXPECT_EQ(flash.program(FakeFlash::kSectors * FakeFlash::kWords - 3, kWords),
            FlashStatus::kOutside);
  EXPECT_EQ(flash.program(0xFFFFFFFF, kWords), FlashStatus::kOutside);
  EXPECT_EQ(fake.operations, 0U);
  EXPECT_EQ(flash.erase(FakeFlash::kSectors - 1), FlashStatus::kOk);
  EXPECT_EQ(flash.program(FakeFlash::kSectors * FakeFlash::kWords - 4, kWords), FlashStatus::kOk);
}

TEST_F(Flash, VerifiesWordsByReadBack) {
  EXPECT_EQ(programmer().program(0, kWords), FlashStatus::kReadBack);
  EXPECT_EQ(fake.operations, 1U) << "it went on after the first that failed";
  fake.worn_cell = 3;
  EXPECT_EQ(programmer().erase(0), FlashStatus::kReadBack);
}

TEST_F(Flash, LimitsWaitWhileBusy) {
  ASSERT_EQ(programmer().erase(0), FlashStatus::kOk);
  fake.busy_polls = 10;
  EXPECT_EQ(programmer().program(0, kWords), FlashStatus::kOk);
  fake.busy_polls = 12;  // the first poll counts one down
  EXPECT_EQ(programmer().program(4, std::span(kWords).first(1)), FlashStatus::kTimeout);
}

TEST_F(Flash, AvoidsAccessWhileBusy) {
  fake.never_ready = true;
  EXPECT_EQ(programmer().erase(0), FlashStatus::kTimeout);
  EXPECT_EQ(programmer().erase(1), FlashStatus::kTimeout);  // not even opened
  EXPECT_EQ(fake.operations, 1U);
}

TEST_F(Flash, ReportsProtectedSector) {
  fake.protected_sector = 5 + 2;
  EXPECT_EQ(programmer().erase(2), FlashStatus::kProtected);
  EXPECT_EQ(programmer().program(2 * FakeFlash::kWords, kWords), FlashStatus::kProtected);
  EXPECT_EQ(programmer().erase(1), FlashStatus::kOk) << "the error of before was not cleared";
  EXPECT_TRUE(fake.locked());
}

TEST_F(Flash, ReportsRejectedKeys) {
  fake.keys_work = false;
  EXPECT_EQ(programmer().erase(0), FlashStatus::kLocked);
  EXPECT_EQ(fake.operations, 0U);
}

// Tests of the fake.
TEST_F(Flash, RefusesInvalidWritesInFake) {
  fake.cells()[0] = 1U;
  EXPECT_EQ(fake.block.sr.value, 1U << 7);
  fake.block.keyr = 0xCDEF89ABU;
  fake.block.keyr = 0x45670123U;
  EXPECT_TRUE(fake.locked());
  fake.block.keyr = 0xCDEF89ABU;
  EXPECT_FALSE(fake.locked());
  fake.block.cr = 0x201U;
  fake.cells()[0] = 1U;
  fake.block.cr = 0x201U;
  EXPECT_EQ(fake.violation, "CR written while busy");
  fake.violation.clear();
}

}  // namespace
}  // namespace tactree::test
