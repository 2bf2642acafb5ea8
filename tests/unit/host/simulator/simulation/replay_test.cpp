// A replayed session has the outcomes of the live one, bit for bit.

#include "tactree/simulation/replay.hpp"

#include <gtest/gtest.h>

#include <random>

#include "recorded_session.hpp"
#include "tactree/core/control/between_ticks.hpp"

namespace tactree::test {
namespace {

using simulation::BodyPath;
using simulation::ReplayResult;
using simulation::SceneBody;
using simulation::SceneTarget;
using simulation::SessionWriter;
using simulation::Simulation;

SceneBody moving_plane(const Eigen::Vector3d& velocity, const Eigen::Vector3d& turn) {
  SceneBody body;
  body.blob = touched_plane().bytes();
  body.path = BodyPath(Eigen::Isometry3d::Identity(), velocity, turn);
  return body;
}

void expect_same(const RecordedSession& session) {
  const ReplayResult replayed = replay_bytes(session.bytes);
  ASSERT_TRUE(replayed.same()) << replayed.difference->tick << ": " << replayed.difference->cause;
  EXPECT_EQ(replayed.summary.ticks, session.summary.ticks);
  EXPECT_EQ(replayed.summary.trace_crc32, session.summary.trace_crc32);
  EXPECT_EQ(replayed.summary.contact_ticks, session.summary.contact_ticks);
  EXPECT_EQ(replayed.summary.faults.size(), session.summary.faults.size());
}

TEST(Replay, ReproducesSessionWithStillBody) {
  const RecordedSession session = record_session(std::make_unique<simulation::HostTarget>());
  EXPECT_GT(session.summary.contact_ticks, 100U);
  expect_same(session);
}

TEST(Replay, ReproducesSessionsWithMovingBodies) {
  const SceneBody first = moving_plane({5e-4, -3e-4, 2e-4}, {0.02, 0.01, 0.3});
  SceneBody second = moving_plane({0.0, 0.0, 1e-3}, {0.0, 0.1, 0.0});
  second.from_s = 0.3;
  second.until_s = 0.7;
  for (const std::vector<SceneBody>& bodies : {std::vector{first}, std::vector{first, second}}) {
    const RecordedSession session =
        record_session(std::make_unique<SceneTarget>(bodies, Simulation::arming_ticks({})));
    EXPECT_GT(session.summary.contact_ticks, 100U);
    expect_same(session);
  }
}

TEST(Replay, ReproducesInjectedFaults) {
  for (const char* text :
       {"encoder2:disconnected@0.5s", "encoder1:stuck@0.2s", "encoder3:jump=500@0.4s",
        "loop:overrun=2@0.3s", "estop:pressed@0.6s", "supply:sag=12@0.5s", "link:dead@0.2s",
        "link:arm@0.2s", "enable:off@0.5s"}) {
    const RecordedSession session = record_session(std::make_unique<simulation::HostTarget>(),
                                                   {simulation::parse_injection(text)});
    SCOPED_TRACE(text);
    expect_same(session);
  }
}

/// Random messages, bodies, forces, readings and changes between ticks.
class RandomSession {
 public:
  explicit RandomSession(std::uint32_t seed) : random_(seed) {
    EXPECT_TRUE(loop_.start(configuration()).ok());
    EXPECT_EQ(add_raised(), core::ModelStatus::kOk);
  }

  void tick() {
    operate();
    change();
    move_bodies();
    if (chance(10)) {
      board_.link().add_force({{real(2.0F), real(2.0F), real(2.0F)}, below(200)});
    }
    z_m_ += chance(2) ? 1e-4 : -1e-4;
    z_m_ = std::clamp(z_m_, -2e-3, 4e-3);
    board_.sample({0.0, 0.0, z_m_});
    const core::Status& status = loop_.tick().status;
    const bool active = status.state == core::State::kActive;
    contact_ticks_ += active && status.rendering.in_contact ? 1 : 0;
  }

  SessionWriter& writer() { return writer_; }
  core::Controller& controller() { return controller_; }
  [[nodiscard]] int contact_ticks() const { return contact_ticks_; }
  [[nodiscard]] int removals() const { return removals_; }

 private:
  static core::Configuration configuration() {
    core::Configuration c;
    c.device.homing = core::HomingMethod::kAbsolute;
    c.limits.ramp_s = 0.01F;
    c.use_materials = false;
    return c;
  }
  static core::Pose raised() { return {{}, {0.0F, 0.0F, 1e-3F}}; }
  std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(random_() % end); }
  bool chance(std::uint32_t of) { return below(of) == 0U; }
  float real(float range) { return range * (static_cast<float>(below(2001)) * 1e-3F - 1.0F); }

  void operate() {
    const core::State state = controller_.state();
    core::Command command = core::Command::kNone;
    if (state == core::State::kFault) {
      command = chance(2) ? core::Command::kClearFault : core::Command::kStop;
    } else if (state == core::State::kIdle) {
      command = core::Command::kArm;
    } else if (chance(400)) {
      command = core::Command::kStop;
    }
    board_.link().post(command);
    board_.safety_inputs().hold_dead_man(state == core::State::kActive ||
                                         (state == core::State::kArmed && chance(4)));
    board_.safety_inputs().press_emergency_stop(chance(700));
    if (chance(900)) {
      board_.ticker().miss(2);
    }
    if (chance(900)) {
      jump_ = -jump_;  // and back the next time
      board_.encoders().jump(2, jump_);
    }
  }

  void change() {
    if (chance(50)) {
      core::Adjustment adjustment = controller_.adjustment();
      adjustment.contact.stiffness_N_m = 200.0F + 100.0F * static_cast<float>(below(4));
      adjustment.contact.damping_Ns_m = 0.1F * static_cast<float>(below(8));
      adjustment.contact.texture_height_m = 1e-4F * static_cast<float>(below(3));
      adjustment.limits.force_max_N = chance(8) ? 4.0F : adjustment.limits.force_max_N;
      (void)changes_.adjust(adjustment);
    }
    if (chance(300)) {  // in any state
      removals_ += changes_.remove_body(below(3)) == core::ModelStatus::kOk ? 1 : 0;
    }
    if (controller_.motors_off()) {
      change_with_motors_off();
    }
  }

  void change_with_motors_off() {
    if (chance(40)) {
      (void)changes_.configure(configuration());
    }
    if (chance(60)) {
      removals_ += changes_.unload_model() == core::ModelStatus::kOk ? 1 : 0;
    }
    if (chance(40) || !controller_.has_body(0)) {
      (void)changes_.load_model(touched_plane().view());
    }
    if (chance(20)) {
      (void)add_raised();
    }
  }

  core::ModelStatus add_raised() {
    std::uint32_t number = 0;
    return changes_.add_body(touched_plane().view(), raised(), number);
  }

  void move_bodies() {
    updates_.clear();
    for (std::uint32_t body = 0; body < 3U; ++body) {
      if (chance(3)) {
        updates_.push_back({body,
                            !chance(20),
                            {{}, {0.0F, 0.0F, real(1e-3F)}},
                            {{real(1e-2F), 0.0F, real(1e-2F)}, {0.0F, 0.0F, real(0.5F)}}});
      }
    }
    board_.link().move_bodies(updates_);
  }

  std::mt19937 random_;
  SessionWriter writer_;
  hal::sim::SimBoard board_{{.recorder = &writer_}, touched_plane().bytes()};
  core::Controller controller_;
  hal::Loop<hal::sim::SimBoard> loop_{board_, controller_};
  core::Uninterrupted<hal::sim::SimBoard> one_thread_{board_};
  core::BetweenTicks<core::Uninterrupted<hal::sim::SimBoard>> changes_{controller_, one_thread_};
  std::vector<core::BodyUpdate> updates_;
  double z_m_ = 4e-3;
  std::int32_t jump_ = -400;
  int contact_ticks_ = 0;
  int removals_ = 0;
};

// Fails if anything except Input and the recorded changes reaches the controller.
TEST(Replay, ReproducesSessionsOfRandomActivity) {
  int contact_ticks = 0;
  int removals = 0;
  for (std::uint32_t seed = 1; seed <= 10U; ++seed) {
    RandomSession session(seed);
    for (int i = 0; i < 3000; ++i) {
      session.tick();
    }
    contact_ticks += session.contact_ticks();
    removals += session.removals();
    const ReplayResult replayed = replay_bytes(session.writer().finish());
    ASSERT_TRUE(replayed.same()) << seed << ", tick " << replayed.difference->tick << ": "
                                 << replayed.difference->cause;
    EXPECT_EQ(replayed.ticks, 3000U);
  }
  EXPECT_GT(contact_ticks, 500);
  EXPECT_GT(removals, 20);
}

TEST(Replay, LocatesUnrecordedChange) {
  RandomSession session(3);
  for (int i = 0; i < 500; ++i) {
    session.tick();
  }
  for (int i = 0; i < 2500; ++i) {
    core::Adjustment adjustment = session.controller().adjustment();
    adjustment.contact.stiffness_N_m = 150.0F;
    ASSERT_EQ(session.controller().adjust(adjustment), core::ConfigurationStatus::kOk);
    session.tick();
  }
  const ReplayResult replayed = replay_bytes(session.writer().finish());
  ASSERT_FALSE(replayed.same());
  EXPECT_GE(replayed.difference->tick, 500U);
  EXPECT_EQ(replayed.difference->tick, replayed.ticks);
}

}  // namespace
}  // namespace tactree::test
