// A simulated user operates a board by its button, dead-man control and lamp.

#include "tactree/simulation/user.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "analytic_shapes.hpp"
#include "panel_session.hpp"
#include "tactree/simulation/hand_script.hpp"

namespace tactree::test {
namespace {

TEST(User, ParsesPresses) {
  const simulation::Press press = simulation::parse_press("0.5s..1.75");
  EXPECT_EQ(press.from_s, 0.5);
  EXPECT_EQ(press.until_s, 1.75);
  for (const char* text :
       {"", "1", "..1", "1..", "2..1", "1..1", "-1..1", "a..b", "1..nan", "1..1e99"}) {
    EXPECT_THROW((void)simulation::parse_press(text), std::invalid_argument) << text;
  }
}

TEST(User, OperatesStandAloneBoard) {
  const Shape shape = cos_sheet();
  for (const float rate_hz : {1000.0F, 3000.0F}) {
    simulation::Setup setup = standing_alone({});
    setup.controller.rate_hz = rate_hz;
    simulation::Simulation sim(shape.bytes(), setup,
                               simulation::make_script("rub", shape.view(), 2.0));
    expect_operated(operate_by_panel(sim, rate_hz));
  }
}

// The simulated application sends a message in each tick, unless the board stands alone.
TEST(User, HasNoApplicationOnStandAloneBoard) {
  const Shape shape = cos_sheet();
  simulation::Setup setup = standing_alone({});
  setup.homed = true;
  simulation::Simulation sim(shape.bytes(), setup,
                             simulation::make_script("rub", shape.view(), 2.0));
  for (const core::Command command :
       {core::Command::kArm, core::Command::kHome, core::Command::kClearFault}) {
    EXPECT_FALSE(sim.post(command));
  }
  (void)sim.step();
  (void)sim.step();
  EXPECT_EQ(sim.state(), core::State::kIdle);
}

TEST(User, MayStopBoardThatStandsAlone) {
  const Shape shape = cos_sheet();
  simulation::Simulation sim(shape.bytes(), standing_alone({}),
                             simulation::make_script("rub", shape.view(), 2.0));
  simulation::User user(1000.0, 2.0, {{0.1, 1.2}, {1.8, 2.9}});
  while (sim.time_s() < 4.0) {
    (void)user.step(sim);
  }
  ASSERT_EQ(sim.state(), core::State::kActive);
  EXPECT_TRUE(sim.post(core::Command::kStop));
  EXPECT_EQ(user.step(sim).status.force, core::Vec3{});
  EXPECT_EQ(sim.state(), core::State::kIdle);
}

}  // namespace
}  // namespace tactree::test
