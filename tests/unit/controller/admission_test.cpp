// A model that the board cannot render in time is not loaded, and there is no force.

#include <gtest/gtest.h>

#include "session.hpp"

namespace tactree::test {
namespace {

/// A tick takes 1000 cycles, 10 more for each point of a ball; with several bodies twice as many.
core::TickCosts some_costs() {
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  for (auto& kind : costs.of) {
    for (std::uint32_t row = 0; row < core::kMaxReachableBodies; ++row) {
      kind[row].base = 1000U * (row + 1U);
      kind[row].per_figure[0] = 10U * (row + 1U);
    }
  }
  return costs;
}

std::uint32_t needed() { return 1000U + 10U * shared_plane().view().header().points_per_ball_max; }

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
  ASSERT_EQ(load(costs, 2U * needed() - 1U, controller), core::ModelStatus::kOk);
  std::uint32_t number = 0;
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kTooSlow);
  controller.know_costs(costs, 2U * needed() * 1000U);
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kOk);
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
