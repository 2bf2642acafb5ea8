#include "tactree/share/outbox.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace tactree::test {
namespace {

share::Message message(const std::string& text) {
  return std::make_shared<const std::string>(text);
}

TEST(ShareOutbox, TakesOneTickOfSeveral) {
  share::Outbox outbox;
  EXPECT_FALSE(outbox.is_due(1));
  outbox.subscribe(3, 1);
  EXPECT_TRUE(outbox.is_due(7));
  outbox.push(message("7"), 7);
  EXPECT_FALSE(outbox.is_due(9));
  EXPECT_TRUE(outbox.is_due(10));
  EXPECT_TRUE(outbox.is_due(2));  // after a reset of the board
  outbox.subscribe(0, 1);
  EXPECT_FALSE(outbox.is_due(100));
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST(ShareOutbox, DropsOldestStatesOfSlowClient) {
  share::Outbox outbox;
  outbox.subscribe(1, 2);
  for (std::uint32_t tick = 1; tick <= 5; ++tick) {
    outbox.push(message(std::to_string(tick)), tick);
  }
  EXPECT_EQ(outbox.dropped(), 3U);
  EXPECT_EQ(*outbox.pop(), "4");
  EXPECT_EQ(*outbox.pop(), "5");
  EXPECT_EQ(outbox.pop(), nullptr);
}

}  // namespace
}  // namespace tactree::test
