// The transition table, written a second time from docs/SAFETY.md's rules, entry by entry.

#include "tactree/core/control/state_machine.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

namespace tactree::test {
namespace {

using core::Event;
using core::State;

/// Every allowed transition. All others are faults.
const std::map<std::pair<State, Event>, State> kAllowed = {
    {{State::kBoot, Event::kConfigured}, State::kNoModel},
    {{State::kBoot, Event::kModelRemoved}, State::kBoot},
    {{State::kBoot, Event::kStop}, State::kBoot},
    {{State::kBoot, Event::kClear}, State::kBoot},
    {{State::kBoot, Event::kUnready}, State::kBoot},
    {{State::kBoot, Event::kRecover}, State::kBoot},
    {{State::kNoModel, Event::kConfigured}, State::kNoModel},
    {{State::kNoModel, Event::kModelLoaded}, State::kIdle},
    {{State::kNoModel, Event::kModelRemoved}, State::kNoModel},
    {{State::kNoModel, Event::kStop}, State::kNoModel},
    {{State::kNoModel, Event::kClear}, State::kNoModel},
    {{State::kNoModel, Event::kUnready}, State::kNoModel},
    {{State::kNoModel, Event::kRecover}, State::kNoModel},
    {{State::kIdle, Event::kConfigured}, State::kIdle},
    {{State::kIdle, Event::kModelLoaded}, State::kIdle},
    {{State::kIdle, Event::kModelRemoved}, State::kNoModel},
    {{State::kIdle, Event::kArm}, State::kArmed},
    {{State::kIdle, Event::kStop}, State::kIdle},
    {{State::kIdle, Event::kClear}, State::kIdle},
    {{State::kIdle, Event::kUnready}, State::kIdle},
    {{State::kIdle, Event::kRecover}, State::kIdle},
    {{State::kArmed, Event::kArm}, State::kArmed},
    {{State::kArmed, Event::kStop}, State::kIdle},
    {{State::kArmed, Event::kClear}, State::kArmed},
    {{State::kArmed, Event::kReady}, State::kActive},
    {{State::kArmed, Event::kUnready}, State::kArmed},
    {{State::kActive, Event::kArm}, State::kActive},
    {{State::kActive, Event::kStop}, State::kIdle},
    {{State::kActive, Event::kClear}, State::kActive},
    {{State::kActive, Event::kReady}, State::kActive},
    {{State::kActive, Event::kUnready}, State::kArmed},
    {{State::kFault, Event::kRecover}, State::kBoot},
};

State state_at(std::uint32_t i) { return static_cast<State>(i); }
Event event_at(std::uint32_t i) { return static_cast<Event>(i); }

TEST(StateMachine, MatchesListedTransitions) {
  for (std::uint32_t s = 0; s < core::kStates; ++s) {
    for (std::uint32_t e = 0; e < core::kEvents; ++e) {
      const auto listed = kAllowed.find({state_at(s), event_at(e)});
      const State expected = listed == kAllowed.end() ? State::kFault : listed->second;
      EXPECT_EQ(core::next_state(state_at(s), event_at(e)), expected)
          << core::name_of(state_at(s)) << " x event " << e;
    }
  }
}

TEST(StateMachine, ReachesActiveOnlyFromArmed) {
  for (std::uint32_t s = 0; s < core::kStates; ++s) {
    for (std::uint32_t e = 0; e < core::kEvents; ++e) {
      const State next = core::next_state(state_at(s), event_at(e));
      if (next == State::kActive && state_at(s) != State::kActive) {
        EXPECT_EQ(state_at(s), State::kArmed);
        EXPECT_EQ(event_at(e), Event::kReady);
      }
      if (next == State::kArmed && state_at(s) != State::kArmed && state_at(s) != State::kActive) {
        EXPECT_EQ(state_at(s), State::kIdle);
        EXPECT_EQ(event_at(e), Event::kArm);
      }
    }
  }
}

TEST(StateMachine, LeavesFaultOnlyByRecover) {
  for (std::uint32_t s = 0; s < core::kStates; ++s) {
    EXPECT_EQ(core::next_state(state_at(s), Event::kFault), State::kFault);
  }
  for (std::uint32_t e = 0; e < core::kEvents; ++e) {
    const bool leaves = core::next_state(State::kFault, event_at(e)) != State::kFault;
    EXPECT_EQ(leaves, event_at(e) == Event::kRecover);
  }
}

TEST(StateMachine, NamesEveryState) {
  EXPECT_EQ(std::string(core::name_of(State::kBoot)), "boot");
  EXPECT_EQ(std::string(core::name_of(State::kNoModel)), "no-model");
  EXPECT_EQ(std::string(core::name_of(State::kIdle)), "idle");
  EXPECT_EQ(std::string(core::name_of(State::kArmed)), "armed");
  EXPECT_EQ(std::string(core::name_of(State::kActive)), "active");
  EXPECT_EQ(std::string(core::name_of(State::kFault)), "fault");
  EXPECT_EQ(std::string(core::name_of(static_cast<State>(200))), "unknown");
}

}  // namespace
}  // namespace tactree::test
