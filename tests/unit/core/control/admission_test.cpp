// A model that the board cannot render in time is not loaded, and there is no force.

#include "tactree/core/control/admission.hpp"

#include <gtest/gtest.h>

#include <random>

#include "controller_rig.hpp"

namespace tactree::test {
namespace {

constexpr std::uint32_t kBase = 200U;

/// Costs of 800 cycles per body and 10 per further point of a ball, in the row without gathers.
core::TickCosts some_costs() {
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  costs.base = kBase;
  for (auto& rows : costs.surface) {
    for (std::uint32_t bodies = 1; bodies <= core::kMaxReachableBodies; ++bodies) {
      for (std::uint32_t work_tier = 0; work_tier < core::kWorkTiers; ++work_tier) {
        rows[core::first_row(work_tier, bodies)].base = 800U;
        rows[core::first_row(work_tier, bodies)].per_limit[0] = 10U;
      }
    }
  }
  return costs;
}

std::uint32_t needed_by_body() {
  return 800U + 10U * (shared_plane().view().header().points_per_ball_max -
                       core::kLeastLimits.points_per_ball_max);
}
std::uint32_t needed() { return kBase + needed_by_body(); }

core::ModelStatus load(const core::TickCosts& costs, std::uint32_t cycles_per_tick,
                       core::Controller& controller) {
  core::Configuration configuration;
  controller.know_costs(costs, cycles_per_tick * 1000U);
  EXPECT_EQ(controller.configure(configuration), core::ConfigurationStatus::kOk);
  return controller.load_model(shared_plane().view());
}

TEST(Admission, LoadsExactlyFittingModel) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  EXPECT_EQ(load(costs, needed(), controller), core::ModelStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kIdle);
}

TEST(Admission, RefusesOneExcessCycle) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  EXPECT_EQ(load(costs, needed() - 1U, controller), core::ModelStatus::kTooSlow);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
  core::Input input;
  input.command = core::Command::kArm;
  EXPECT_FALSE(controller.step(input).enable);
}

TEST(Admission, CountsMinimumLimits) {
  core::TickCost cost;
  cost.base = 700U;
  for (std::uint16_t& price : cost.per_limit) {
    price = 10U;
  }
  EXPECT_EQ(core::cycles_of(cost, core::ModelLimits{}), 700U);
  core::ModelLimits limits = core::kLeastLimits;
  EXPECT_EQ(core::cycles_of(cost, limits), 700U);
  ++limits.points_per_ball_max;
  ++limits.blended_materials;
  limits.depth = 0;
  EXPECT_EQ(core::cycles_of(cost, limits), 720U);
}

TEST(Admission, LoadsModelWithUnknownCosts) {
  const core::TickCosts costs;
  core::Controller controller;
  EXPECT_EQ(load(costs, 1, controller), core::ModelStatus::kOk);
}

TEST(Admission, AddsTimeOfSecondBody) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  const std::uint32_t both = needed() + needed_by_body();
  ASSERT_EQ(load(costs, both - 1U, controller), core::ModelStatus::kOk);
  std::uint32_t number = 0;
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kTooSlow);
  controller.know_costs(costs, both * 1000U);
  EXPECT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kOk);
}

// Each tick visits all bodies of the scene, although it renders two of them at most.
TEST(Admission, AddsTimeOfEachBody) {
  core::TickCosts costs = some_costs();
  costs.listed = 50U;
  core::TickLoad load;
  const core::Configuration configuration;
  for (std::uint32_t bodies = 1; bodies <= core::kMaxBodies; ++bodies) {
    load.add(shared_plane().view().header(), configuration);
    const std::uint32_t rendered =
        bodies < core::kMaxReachableBodies ? bodies : core::kMaxReachableBodies;
    EXPECT_EQ(core::cycles_of(costs, load), kBase + 50U * bodies + rendered * needed_by_body());
  }
}

// A tick divides its work between gathers and fits: the most expensive division counts.
TEST(Admission, UsesMostExpensiveRow) {
  for (std::uint32_t row = 0; row < core::rows_of(0, 1); ++row) {
    core::TickCosts costs = some_costs();
    for (std::uint32_t tier = 1; tier < core::kWorkTiers; ++tier) {
      costs.surface[0][core::first_row(tier, 1)].base = 6000U;
    }
    costs.surface[0][core::first_row(0, 2)].base = 6000U;  // of two bodies
    costs.surface[0][row].base = 5000U;
    costs.surface[0][row].per_limit[0] = 0U;
    core::Controller controller;
    EXPECT_EQ(load(costs, kBase + 4999U, controller), core::ModelStatus::kTooSlow) << row;
    EXPECT_EQ(load(costs, kBase + 5000U, controller), core::ModelStatus::kOk) << row;
  }
}

/// Costs whose tiers take 1000, 900, 800, 700 and 600 cycles for any model.
core::TickCosts costs_that_fall() {
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  for (std::uint32_t tier = 0; tier < core::kWorkTiers; ++tier) {
    for (std::uint32_t bodies = 1; bodies <= core::kMaxReachableBodies; ++bodies) {
      costs.surface[0][core::first_row(tier, bodies)].base = 1000U - 100U * tier;
    }
  }
  return costs;
}

TEST(Admission, ReducesWorkBeforeRefusal) {
  const core::TickCosts costs = costs_that_fall();
  core::Controller controller;
  EXPECT_EQ(load(costs, 1000U, controller), core::ModelStatus::kOk);
  EXPECT_FALSE(controller.work_is_reduced());
  EXPECT_EQ(load(costs, 999U, controller), core::ModelStatus::kOk);
  EXPECT_TRUE(controller.work_is_reduced());
  EXPECT_EQ(load(costs, 600U, controller), core::ModelStatus::kOk);
  EXPECT_TRUE(controller.work_is_reduced());
  EXPECT_EQ(load(costs, 599U, controller), core::ModelStatus::kTooSlow);
}

TEST(Admission, RestoresWorkForLighterScene) {
  const core::TickCosts costs = costs_that_fall();
  core::Controller controller;
  ASSERT_EQ(load(costs, 1000U, controller), core::ModelStatus::kOk);
  std::uint32_t number = 0;
  controller.know_costs(costs, 1300U * 1000U);  // two bodies take 1200 cycles with the least work
  ASSERT_EQ(controller.add_body(shared_plane().view(), {}, number), core::ModelStatus::kOk);
  EXPECT_TRUE(controller.work_is_reduced());
  ASSERT_EQ(controller.load_model(shared_plane().view()), core::ModelStatus::kOk);
  EXPECT_FALSE(controller.work_is_reduced());
}

// A tick with reduced work takes no more of it than its tier allows.
TEST(Admission, LimitsTickToReducedWork) {
  for (std::uint32_t tier = 0; tier < core::kWorkTiers; ++tier) {
    EXPECT_EQ(&core::work_per_tick(500.0F, tier), &core::kWorkPerTick[tier]);
    EXPECT_EQ(&core::work_per_tick(1500.0F, tier), &core::kWorkPerTick[tier < 1U ? 1U : tier]);
  }
}

TEST(Admission, AdmitsEveryLowerRate) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::uint32_t> cycles(0, 200000U);
  std::uint32_t admitted = 0;
  for (std::uint32_t board = 0; board < 200U; ++board) {
    core::TickCosts costs;
    costs.known = core::kTickCostsKnown;
    costs.base = cycles(random) / 8U;
    for (core::TickCost& row : costs.surface[0]) {
      row.base = cycles(random);
    }
    bool is_admitted = false;
    for (float rate_hz = 20000.0F; rate_hz > 100.0F; rate_hz *= 0.93F) {
      core::Configuration configuration;
      configuration.rate_hz = rate_hz;
      core::TickLoad of_one;
      of_one.add(shared_plane().view().header(), configuration);
      core::Admission admission;
      admission.know_costs(costs, 168000000U);
      const bool now = admission.work_tier(of_one, configuration) < core::kWorkTiers;
      EXPECT_TRUE(now || !is_admitted) << rate_hz;
      is_admitted = now;
    }
    admitted += is_admitted ? 1U : 0U;
  }
  EXPECT_EQ(admitted, 200U);  // every board renders the model at 100 Hz
}

TEST(Admission, AddsCyclesOfDelta) {
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

TEST(Admission, UnloadsModelAtHigherRate) {
  const core::TickCosts costs = some_costs();
  core::Controller controller;
  ASSERT_EQ(load(costs, needed(), controller), core::ModelStatus::kOk);
  core::Configuration faster;
  faster.rate_hz = 1001.0F;
  EXPECT_EQ(controller.configure(faster), core::ConfigurationStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
}

TEST(Admission, UsesLargestLimitsOfModels) {
  core::TickLoad load;
  core::BlobHeader header{};
  header.points_per_ball_max = 7;
  header.points_per_support_max = 4;
  header.depth = 3;
  load.add(header, {});
  header.points_per_ball_max = 5;
  header.points_per_support_max = 0;  // not known: those of the ball
  header.depth = 4;
  header.profile = static_cast<std::uint32_t>(core::Profile::kPaper);
  load.add(header, {});
  EXPECT_EQ(load.limits.points_per_ball_max, 7U);
  EXPECT_EQ(load.limits.points_per_support_max, 5U);
  EXPECT_EQ(load.limits.depth, 4U);
  EXPECT_EQ(load.kind, core::TickKind::kMixed);
  EXPECT_EQ(load.bodies, 2U);
}

}  // namespace
}  // namespace tactree::test
