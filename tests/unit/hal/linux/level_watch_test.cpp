#include "tactree/hal/linux/level_watch.hpp"

#include <gtest/gtest.h>

namespace tactree::hal::linux_gpio {
namespace {

constexpr std::uint64_t kLimit_ns = 2'000'000;
constexpr std::uint64_t kLine0 = 1;
constexpr std::uint64_t kLine1 = 2;

TEST(LevelWatch, FindsPersistentlyDifferentLine) {
  LevelWatch watch(kLimit_ns);
  EXPECT_EQ(watch.look(kLine1, 0, 100), 0U);
  EXPECT_EQ(watch.look(kLine0 | kLine1, 0, 99 + kLimit_ns), 0U);
  EXPECT_EQ(watch.look(kLine0 | kLine1, 0, 100 + kLimit_ns), kLine1);
  EXPECT_EQ(watch.look(kLine0, 0, 101 + kLimit_ns), 0U) << "line 0 since now";
  EXPECT_EQ(watch.look(kLine0, 0, 101 + 2 * kLimit_ns), kLine0);
}

TEST(LevelWatch, IgnoresLineWithEdges) {
  LevelWatch watch(kLimit_ns);
  EXPECT_EQ(watch.look(kLine0, 0, 0), 0U);
  EXPECT_EQ(watch.look(0, 0, kLimit_ns), 0U);
  EXPECT_EQ(watch.look(kLine0, 0, kLimit_ns + 1), 0U) << "it was equal meanwhile";
  watch.take(kLine0);
  EXPECT_EQ(watch.look(kLine0, 0, 2 * kLimit_ns + 1), 0U) << "an edge came, and the next is due";
  EXPECT_EQ(watch.look(kLine0, 0, 3 * kLimit_ns + 1), kLine0);
}

TEST(LevelWatch, IgnoresLineWithHeldEdges) {
  LevelWatch watch(kLimit_ns);
  EXPECT_EQ(watch.look(kLine0 | kLine1, 0, 0), 0U);
  EXPECT_EQ(watch.look(kLine0 | kLine1, kLine0, kLimit_ns), kLine1);
  EXPECT_EQ(watch.look(kLine0, kLine0, 3 * kLimit_ns), 0U);
}

}  // namespace
}  // namespace tactree::hal::linux_gpio
