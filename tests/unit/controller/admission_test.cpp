// A model that the board cannot render in time is not loaded, and there is no force.

#include <gtest/gtest.h>

#include "session.hpp"

namespace tactree::test {
namespace {

constexpr std::uint32_t kBase = 200U;

/// Each body takes 800 cycles, 10 more for each point of a ball: so says the row of a tick that
/// gathers nothing.
core::TickCosts some_costs() {
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  costs.base = kBase;
  for (auto& rows : costs.surface) {
    for (std::uint32_t pace = 0; pace < core::kPaces; ++pace) {
      rows[core::first_row(pace)].base = 800U;
      rows[core::first_row(pace)].per_figure[0] = 10U;
    }
  }
  return costs;
}

std::uint32_t needed_by_body() {
  return 800U + 10U * shared_plane().view().header().points_per_ball_max;
}
std::uint32_t needed() { return kBase + needed_by_body(); }

core::ModelStatus load(const core::TickCosts& costs, std::uint32_t cycles_per_tick,
                       core::Controller& controller) {
  core::Configuration configuration;
  controller.know_costs(costs, cycles_per_tick * 1000U);
  EXPECT_EQ(controller.configure(configuration), core::ConfigurationStatus::kOk);
  return controller.load_model(shared_plane().view());
}

TEST(Admission, AModelThatFitsToTheCycleIsLoaded) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  EXPECT_EQ(load(costs, needed(), controller), core::ModelStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kIdle);
}

TEST(Admission, OneCycleTooManyIsRefused) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  EXPECT_EQ(load(costs, needed() - 1U, controller), core::ModelStatus::kTooSlow);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
  core::Input input;
  input.command = core::Command::kArm;
  EXPECT_FALSE(controller.step(input).enable);
}

TEST(Admission, UnknownCostsRefuseNothing) {
  const core::TickCosts costs;
  core::Controller controller;
  EXPECT_EQ(load(costs, 1, controller), core::ModelStatus::kOk);
}

TEST(Admission, ASecondBodyNeedsTimeOfItsOwn) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  const std::uint32_t both = needed() + needed_by_body();
  ASSERT_EQ(load(costs, both - 1U, controller), core::ModelStatus::kOk);
  std::uint32_t number = 0;
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kTooSlow);
  controller.know_costs(costs, both * 1000U);
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kOk);
}

// The more of a tick's work is gathers, the less is fits: the worst of all ways counts.
TEST(Admission, TheCostliestRowCounts) {
  for (std::uint32_t row = 0; row < core::rows_of_pace(0); ++row) {
    core::TickCosts costs = some_costs();
    costs.surface[0][row].base = 5000U;
    costs.surface[0][row].per_figure[0] = 0U;
    core::Controller controller;
    EXPECT_EQ(load(costs, kBase + 4999U, controller), core::ModelStatus::kTooSlow) << row;
    EXPECT_EQ(load(costs, kBase + 5000U, controller), core::ModelStatus::kOk) << row;
  }
}

TEST(Admission, ADeltaTakesLonger) {
  core::TickCosts costs = some_costs();
  costs.delta = 100U;
  core::TickLoad load;
  core::Configuration configuration;
  load.add(shared_plane().view().header(), configuration);
  EXPECT_EQ(core::cycles_of(costs, load), needed());
  configuration.device.kind = core::DeviceKind::kDelta;
  core::TickLoad of_delta;
  of_delta.add(shared_plane().view().header(), configuration);
  EXPECT_EQ(core::cycles_of(costs, of_delta), needed() + 100U);
}

TEST(Admission, AHigherRateTakesOutWhatItCannotKeep) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  ASSERT_EQ(load(costs, needed(), controller), core::ModelStatus::kOk);
  core::Configuration faster;
  faster.rate_hz = 1001.0F;
  EXPECT_EQ(controller.configure(faster), core::ConfigurationStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
}

TEST(Admission, TheFiguresOfSeveralModelsAreTheLargest) {
  core::TickLoad load;
  core::BlobHeader header{};
  header.points_per_ball_max = 7;
  header.depth = 3;
  load.add(header, {});
  header.points_per_ball_max = 5;
  header.depth = 4;
  header.profile = static_cast<std::uint32_t>(core::Profile::kPaper);
  load.add(header, {});
  EXPECT_EQ(load.figures.points_per_ball_max, 7U);
  EXPECT_EQ(load.figures.depth, 4U);
  EXPECT_EQ(load.kind, core::TickKind::kMixed);
  EXPECT_EQ(load.bodies, 2U);
}

}  // namespace
}  // namespace tactree::test
