#include "tactree/simulation/repeated_path.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

namespace tactree::test {
namespace {

using core::State;
using simulation::Sample;

/// A tick each millisecond, in these states, with contact or without; the probe moves 1 m in each.
std::vector<Sample> recorded(const std::vector<std::pair<State, bool>>& ticks) {
  std::vector<Sample> samples;
  for (const auto& [state, in_contact] : ticks) {
    const std::size_t number = samples.size() + 1;
    Sample& sample = samples.emplace_back();
    sample.t_s = 0.001 * static_cast<double>(number);
    sample.status.state = state;
    sample.status.probe.z = static_cast<float>(number);
    sample.status.rendering.in_contact = in_contact;
  }
  return samples;
}

TEST(RepeatedPath, HasActiveTicksFromFirstWithoutContact) {
  const auto path = simulation::repeated_path(recorded({{State::kIdle, false},
                                                        {State::kActive, true},
                                                        {State::kActive, false},
                                                        {State::kFault, false},
                                                        {State::kActive, true}}));
  ASSERT_EQ(path.waypoints().size(), 2U);
  EXPECT_EQ(path.waypoints()[0].t_s, 0.0);
  EXPECT_EQ(path.waypoints()[0].position_m, Eigen::Vector3d(0.0, 0.0, 3.0));
  EXPECT_NEAR(path.waypoints()[1].t_s, 0.002, 1e-12);
  EXPECT_EQ(path.waypoints()[1].position_m.z(), 5.0);
}

TEST(RepeatedPath, HasAllActiveTicksIfAllHaveContact) {
  const auto path = simulation::repeated_path(
      recorded({{State::kIdle, false}, {State::kActive, true}, {State::kActive, true}}));
  ASSERT_EQ(path.waypoints().size(), 2U);
  EXPECT_EQ(path.waypoints()[0].t_s, 0.0);
}

TEST(RepeatedPath, NeedsActiveTick) {
  EXPECT_THROW((void)simulation::repeated_path(recorded({{State::kIdle, false}})),
               std::invalid_argument);
  EXPECT_THROW((void)simulation::repeated_path({}), std::invalid_argument);
}

}  // namespace
}  // namespace tactree::test
