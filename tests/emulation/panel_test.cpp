// A board that stands alone: its firmware reads the button and drives the lamp, as on the host.

#include <memory>

#include "boards_for_test.hpp"
#include "panel_session.hpp"
#include "tactree/simulation/hand_script.hpp"

namespace tactree::test {
namespace {

class StandingAlone : public OnBoard {};
TACTREE_ON_EVERY_BOARD(StandingAlone);

TEST_P(StandingAlone, IsOperatedByItsPanel) {
  const simulation::Setup setup = standing_alone({});
  const simulation::HandPath path = simulation::make_script("rub", touched_shape().view(), 2.0);
  simulation::Simulation on_host(touched_shape().bytes(), setup, path);
  const PanelSession expected = operate_by_panel(on_host, setup.controller.rate_hz);
  simulation::Simulation on_board(
      touched_shape().bytes(), setup, path,
      std::make_unique<emulation::EmulatedTarget>(board(), touched_shape().bytes(), options()));
  const PanelSession found = operate_by_panel(on_board, setup.controller.rate_hz);
  expect_operated(found);
  EXPECT_EQ(found.trace_crc32, expected.trace_crc32);
  ASSERT_EQ(found.samples.size(), expected.samples.size());
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    ASSERT_EQ(found.samples[i].lamp, expected.samples[i].lamp) << "tick " << i;
    ASSERT_EQ(found.samples[i].status.state, expected.samples[i].status.state) << "tick " << i;
  }
}

}  // namespace
}  // namespace tactree::test
