// The checksum of a program with a record, in a simulated flash.

#include "tactree/runtime/self_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

namespace tactree::test {
namespace {

using runtime::ImageRecord;

constexpr std::uint32_t kFlash = 0x08000000;

/// Flash with a program of two ranges: code that contains the record, and initial values.
class Program {
 public:
  Program() : flash_(2000) {
    for (std::size_t i = 0; i < flash_.size(); ++i) {
      flash_[i] = static_cast<std::byte>(i * 7);
    }
    record = runtime::image_record("hc3", {.clock_hz = 168'000'000, .blob_at = kFlash + 4096});
  }

  /// What seal-image does.
  void seal() {
    record.count = 2;
    record.ranges[0] = {kFlash, 1000};
    record.ranges[1] = {kFlash + 1600, 100};
    record.checksum_at = kFlash + 500 + offsetof(ImageRecord, checksum);
    record.checksum = 0;
    store();
    core::Crc32 checksum;
    const std::span<const std::byte> all(flash_);
    checksum.update(all.subspan(0, 500 + offsetof(ImageRecord, checksum)));
    checksum.update(all.subspan(500 + sizeof record, 500 - sizeof record));
    checksum.update(all.subspan(1600, 100));
    record.checksum = checksum.value();
    store();
  }
  void store() { std::memcpy(flash_.data() + 500, &record, sizeof record); }

  [[nodiscard]] std::span<std::byte> flash() { return flash_; }
  [[nodiscard]] bool holds() const {
    ImageRecord stored;
    std::memcpy(&stored, flash_.data() + 500, sizeof stored);
    return runtime::holds_program(stored, [this](std::uint32_t address, std::uint32_t bytes) {
      return std::span<const std::byte>(flash_).subspan(address - kFlash, bytes);
    });
  }

  ImageRecord record{};

 private:
  std::vector<std::byte> flash_;
};

TEST(ImageRecord, HoldsNameAndFacts) {
  constexpr ImageRecord kRecord = runtime::image_record(
      "a-name-of-more-than-23-characters",
      {.clock_hz = 150'000'000, .blob_at = 0x10040000, .blob_room = 1 << 20, .uf2_family = 7});
  EXPECT_EQ(std::string_view(kRecord.mark), "TACTOWN");
  EXPECT_EQ(std::string_view(kRecord.board), "a-name-of-more-than-23-");
  EXPECT_EQ(kRecord.clock_hz, 150'000'000U);
  EXPECT_EQ(kRecord.blob_at, 0x10040000U);
  EXPECT_EQ(kRecord.blob_room, 1U << 20);
  EXPECT_EQ(kRecord.uf2_family, 7U);
  EXPECT_EQ(kRecord.count, 0U) << "not sealed";
}

TEST(SelfTest, AcceptsSealedProgram) {
  Program program;
  program.seal();
  EXPECT_TRUE(program.holds());
}

TEST(SelfTest, RefusesProgramThatIsNotSealed) {
  Program program;
  program.store();
  EXPECT_FALSE(program.holds());
  program.record.count = runtime::kMaxRanges + 1U;
  program.store();
  EXPECT_FALSE(program.holds());
}

TEST(SelfTest, DetectsEveryFlippedBitOfProgram) {
  Program program;
  program.seal();
  const auto is_program = [](std::size_t i) { return i < 1000 || (i >= 1600 && i < 1700); };
  // A flipped bit of the ranges would make the test read outside of this flash.
  const std::size_t begin = 500 + offsetof(ImageRecord, count);
  const std::size_t end = 500 + offsetof(ImageRecord, checksum);
  for (std::size_t i = 0; i < program.flash().size(); ++i) {
    if (i >= begin && i < end) {
      continue;
    }
    for (int bit = 0; bit < 8; ++bit) {
      program.flash()[i] ^= static_cast<std::byte>(1 << bit);
      EXPECT_EQ(program.holds(), !is_program(i)) << i << " " << bit;
      program.flash()[i] ^= static_cast<std::byte>(1 << bit);
    }
  }
}

TEST(SelfTest, RefusesChangedRange) {
  Program program;
  program.seal();
  program.record.ranges[1].bytes -= 4;
  program.store();
  EXPECT_FALSE(program.holds());
}

}  // namespace
}  // namespace tactree::test
