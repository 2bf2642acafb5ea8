// The configurations of the real boards, as their images are built.

#include "boards/stm32f405/wiring.hpp"

#include <gtest/gtest.h>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/hal/panel.hpp"

// The boards use the same names; no image contains two of them.
#define wiring stm32h743_wiring
#include "boards/stm32h743/wiring.hpp"
#undef wiring
#define wiring rp2350_wiring
#include "boards/rp2350/wiring.hpp"
#undef wiring

namespace tactree::test {
namespace {

using firmware::wiring::LinkUse;

TEST(Wiring, GivesFirstForceUntilSignsAreProven) {
  for (const core::Configuration& built :
       {firmware::wiring::configuration(), firmware::stm32h743_wiring::configuration(),
        firmware::rp2350_wiring::configuration()}) {
    EXPECT_EQ(core::check(built), core::ConfigurationStatus::kOk);
    EXPECT_EQ(built.limits.force_max_N, core::kFirstForce_N);
    EXPECT_FALSE(built.motors.signs_proven);
    EXPECT_FALSE(built.compensate_gravity);
    EXPECT_TRUE(built.supervision.dead_man_required);
  }
  for (const core::Configuration& proven :
       {firmware::wiring::configuration(LinkUse::kWatches, true),
        firmware::stm32h743_wiring::configuration(true),
        firmware::rp2350_wiring::configuration(true)}) {
    EXPECT_EQ(core::check(proven), core::ConfigurationStatus::kOk);
    EXPECT_EQ(proven.limits.force_max_N, core::presets::premium().drive.force_max_N);
    EXPECT_TRUE(proven.motors.signs_proven);
    EXPECT_TRUE(proven.compensate_gravity);
  }
}

TEST(Wiring, OffersEveryUseOfLink) {
  for (const LinkUse use : {LinkUse::kMayOperate, LinkUse::kOperates, LinkUse::kWatches}) {
    const core::Configuration c = firmware::wiring::configuration(use);
    EXPECT_EQ(core::check(c), core::ConfigurationStatus::kOk);
    EXPECT_EQ(c.link.required, use == LinkUse::kOperates);
    EXPECT_EQ(c.link.may_command, use != LinkUse::kWatches);
  }
}

// A link that nothing but force depends on, and that cannot start it.
TEST(Wiring, RefusesRequiredLinkThatMayOnlyWatch) {
  core::Configuration c = firmware::wiring::configuration(LinkUse::kOperates);
  c.link.may_command = false;
  EXPECT_EQ(core::check(c), core::ConfigurationStatus::kBadLink);
}

}  // namespace
}  // namespace tactree::test
