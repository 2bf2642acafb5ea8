// Injects every kind of link fault into every message of a session. In all cases the force ends
// within the timeout of a required link, and only arm followed by confirm activates the controller.

#include <gtest/gtest.h>

#include <random>

#include "session_rig.hpp"

namespace tactree::test {
namespace {

using core::State;
using core::wire::ControlCode;
using core::wire::MessageKind;
using Bytes = std::vector<std::byte>;
using Deliveries = std::vector<Wire::Delivery>;

constexpr std::uint16_t kTimeoutMs = 20;  // and ticks
constexpr std::uint64_t kNever = ~std::uint64_t{0};

const TestBlob& blob() {
  static const TestBlob kBlob(sphere(0.03, 0.002));
  return kBlob;
}

core::Configuration quick() {
  core::Configuration c = SessionRig<>::configuration();
  c.limits.ramp_s = 0.01F;
  return c;
}

/// Counts activations of the controller and checks the force in each state.
class Watch {
 public:
  explicit Watch(SessionRig<>& rig) : rig_(rig) {
    rig.after_tick = [this] { look(); };
  }
  [[nodiscard]] int activations() const { return activations_; }
  [[nodiscard]] bool was_touched() const { return touched_; }
  /// The first tick from which on there was no force any more.
  [[nodiscard]] std::uint64_t force_ended() const { return force_ended_; }

 private:
  void look() {
    const State state = rig_.state();
    if (state == State::kActive && last_ != State::kActive) {
      ++activations_;
      EXPECT_EQ(last_, State::kArmed) << "tick " << rig_.ticks();
    }
    if (state != State::kActive) {
      EXPECT_EQ(rig_.status().force, core::Vec3{}) << "tick " << rig_.ticks();
    }
    if (state == State::kActive || rig_.status().force != core::Vec3{}) {
      force_ended_ = rig_.ticks() + 1U;
    }
    touched_ = touched_ || core::length(rig_.status().force) > 0.2F;
    last_ = state;
  }

  SessionRig<>& rig_;
  State last_ = State::kIdle;
  int activations_ = 0;
  bool touched_ = false;
  std::uint64_t force_ended_ = 0;
};

/// Plays an application: continues after failed requests and stops at the end.
void play(SessionRig<>& rig) {
  (void)rig.open(kTimeoutMs);
  (void)rig.ask(MessageKind::kCapabilities);
  (void)rig.ask(MessageKind::kSetLimits, core::wire::SetLimitsRequest{6.0F, 2000.0F, 0.01F});
  (void)rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x0B, 10});
  core::wire::ControlReply armed;
  (void)rig.control(ControlCode::kArm).read(armed);
  rig.settle(10);
  (void)rig.control(ControlCode::kConfirm, armed.token);
  rig.stand_at(0.0293);
  rig.settle(15);
  (void)rig.ask(MessageKind::kAddForce, core::wire::AddForceRequest{{0.5F, 0.0F, 0.0F}, 20});
  (void)rig.ask(MessageKind::kSetMaterial,
                core::wire::SetMaterialRequest{400.0F, 0.5F, 0.4F, 0.3F, 1});
  core::wire::MoveBodyRequest move;
  move.translation_m[1] = 1e-4F;
  (void)rig.ask(MessageKind::kMoveBody, move);
  (void)rig.ask(MessageKind::kReadTrace, core::wire::ReadTraceRequest{0, 13});
  rig.settle(20);
}

/// Ends the session, then delivers the messages still in transit.
void end(SessionRig<>& rig) {
  bool stopped = false;
  for (int i = 0; i < 5 && !stopped; ++i) {
    stopped = rig.control(ControlCode::kStop).ok();
  }
  rig.settle(300);
}

enum class Direction { kToBoard, kToHost, kBoth };

struct Rig {
  store::NoModelStore store;
  SessionRig<> rig{store, quick(), blob().written().bytes};
  Watch watch{rig};

  Wire& wire(Direction direction) {
    return direction == Direction::kToHost ? rig.to_host() : rig.to_board();
  }
};

struct Recorded {
  std::uint64_t to_board = 0;
  std::uint64_t to_host = 0;
  std::vector<Bytes> frames_to_board;
};

/// Records a session without faults.
Recorded record() {
  Rig r;
  play(r.rig);
  EXPECT_TRUE(r.watch.was_touched());
  const Recorded recorded{r.rig.to_board().frames(), r.rig.to_host().frames(),
                          r.rig.to_board().sent()};
  EXPECT_EQ(r.rig.state(), State::kActive);
  end(r.rig);
  EXPECT_EQ(r.watch.activations(), 1);
  return recorded;
}

const Recorded& recorded() {
  static const Recorded kRecorded = record();
  return kRecorded;
}

/// Drops all messages of a direction from a number on.
Wire::Spoiler dead_from(std::uint64_t number, std::uint64_t& died) {
  return [number, &died](std::uint64_t n, std::uint64_t tick, const Bytes& frame) {
    if (n < number && died == kNever) {
      return Deliveries{{tick, frame}};
    }
    died = std::min(died, tick);
    return Deliveries{};
  };
}

TEST(LossyLink, EndsForceAfterLinkFailure) {
  int killed_active = 0;
  for (const Direction direction : {Direction::kToBoard, Direction::kToHost, Direction::kBoth}) {
    const std::uint64_t count =
        direction == Direction::kToHost ? recorded().to_host : recorded().to_board;
    for (std::uint64_t n = 0; n < count; ++n) {
      Rig r;
      std::uint64_t died = kNever;
      r.wire(direction).spoil(dead_from(n, died));
      if (direction == Direction::kBoth) {
        r.rig.to_host().spoil([&died](std::uint64_t, std::uint64_t tick, const Bytes& frame) {
          return died == kNever ? Deliveries{{tick, frame}} : Deliveries{};
        });
      }
      play(r.rig);
      r.rig.settle(2 * kTimeoutMs);
      ASSERT_NE(died, kNever) << "message " << n;
      ASSERT_NE(r.rig.state(), State::kActive) << "message " << n;
      ASSERT_NE(r.rig.state(), State::kArmed) << "message " << n;
      if (r.watch.activations() > 0) {
        ++killed_active;
        ASSERT_LE(r.watch.force_ended(), died + kTimeoutMs) << "message " << n;
      }
    }
  }
  EXPECT_GE(killed_active, 30);
}

/// A fault of one message, or of all from it on.
struct Harm {
  const char* name;
  std::function<Deliveries(std::uint64_t tick, const Bytes& frame, std::uint32_t variant)> act;
  std::uint32_t variants;
};

Bytes flipped(Bytes frame, std::uint32_t bit) {
  frame[(bit / 8U) % frame.size()] ^= static_cast<std::byte>(1U << (bit % 8U));
  return frame;
}

Bytes cut(Bytes frame, std::uint32_t at) {
  frame.resize(at % frame.size());
  return frame;
}

const std::vector<Harm>& harms() {
  static const std::vector<Harm> kHarms = {
      {"lost", [](std::uint64_t, const Bytes&, std::uint32_t) { return Deliveries{}; }, 1},
      {"late",
       [](std::uint64_t tick, const Bytes& frame, std::uint32_t v) {
         constexpr std::uint64_t kDelays[] = {1, 3, 12, 30, 90, 200};
         return Deliveries{{tick + kDelays[v], frame}};
       },
       6},
      {"twice",
       [](std::uint64_t tick, const Bytes& frame, std::uint32_t v) {
         constexpr std::uint64_t kDelays[] = {0, 2, 25, 150};
         return Deliveries{{tick, frame}, {tick + kDelays[v], frame}};
       },
       4},
      {"corrupt",
       [](std::uint64_t tick, const Bytes& frame, std::uint32_t v) {
         return Deliveries{{tick, flipped(frame, 29U * v + 3U)}};
       },
       4},
      {"cut",
       [](std::uint64_t tick, const Bytes& frame, std::uint32_t v) {
         return Deliveries{{tick, cut(frame, 7U * v + 1U)}};
       },
       2},
  };
  return kHarms;
}

// Corrupts one message. The session may fail, but it does not become active twice, and messages in
// transit do not restore the force after stop.
TEST(LossyLink, StaysStoppedDespiteCorruptMessage) {
  for (const Direction direction : {Direction::kToBoard, Direction::kToHost}) {
    const std::uint64_t count =
        direction == Direction::kToHost ? recorded().to_host : recorded().to_board;
    for (const Harm& harm : harms()) {
      for (std::uint32_t variant = 0; variant < harm.variants; ++variant) {
        for (std::uint64_t n = 0; n < count; ++n) {
          Rig r;
          r.wire(direction).spoil([&](std::uint64_t i, std::uint64_t tick, const Bytes& frame) {
            return i == n ? harm.act(tick, frame, variant) : Deliveries{{tick, frame}};
          });
          play(r.rig);
          const int before = r.watch.activations();
          end(r.rig);
          ASSERT_LE(before, 1) << harm.name << " " << n;
          ASSERT_EQ(r.watch.activations(), before) << harm.name << " " << n;
          ASSERT_NE(r.rig.state(), State::kActive) << harm.name << " " << n;
          ASSERT_NE(r.rig.state(), State::kArmed) << harm.name << " " << n;
        }
      }
    }
  }
}

// Delays each message a little more than the one before: messages keep arriving with growing age.
TEST(LossyLink, RefusesQueueOfOldHeartbeats) {
  for (std::uint64_t n = 20; n < recorded().to_board; n += 3) {
    Rig r;
    r.rig.to_board().spoil([&](std::uint64_t i, std::uint64_t tick, const Bytes& frame) {
      return Deliveries{{tick + (i >= n ? 3U * (i - n) : 0U), frame}};
    });
    play(r.rig);
    r.rig.settle(150);
    ASSERT_NE(r.rig.state(), State::kActive) << n;
  }
}

// A round trip within the timeout is as good as none.
// The loop goes on, ends the force in time, and the session is there again afterwards.
TEST(LossyLink, ShutsDownDespiteBlockedDriver) {
  Rig r;
  play(r.rig);
  ASSERT_EQ(r.rig.state(), State::kActive);
  const std::uint64_t hung = r.rig.ticks();
  r.rig.port().stuck = true;
  r.rig.settle(1000);
  EXPECT_EQ(r.rig.ticks(), hung + 1000U);
  EXPECT_LE(r.watch.force_ended(), hung + kTimeoutMs + 3U);
  EXPECT_TRUE(core::has_fault(r.rig.status().faults, core::Fault::kLinkLost));
  r.rig.port().stuck = false;
  r.rig.settle(1000);
  EXPECT_EQ(r.watch.activations(), 1);
  EXPECT_TRUE(r.rig.control(ControlCode::kClearFault).ok());
}

TEST(LossyLink, AcceptsSlowLinkWithinTimeout) {
  Rig r;
  for (Wire* wire : {&r.rig.to_board(), &r.rig.to_host()}) {
    wire->spoil([](std::uint64_t, std::uint64_t tick, const Bytes& frame) {
      return Deliveries{{tick + 4U, frame}};
    });
  }
  play(r.rig);
  EXPECT_EQ(r.rig.state(), State::kActive);
  EXPECT_TRUE(r.watch.was_touched());
}

TEST(LossyLink, NeverReactivatesOnSwappedMessages) {
  for (std::uint64_t n = 0; n + 1U < recorded().to_board; ++n) {
    Rig r;
    Bytes held;
    r.rig.to_board().spoil([&](std::uint64_t i, std::uint64_t tick, const Bytes& frame) {
      if (i == n) {
        held = frame;
        return Deliveries{};
      }
      return i == n + 1U ? Deliveries{{tick, frame}, {tick, held}} : Deliveries{{tick, frame}};
    });
    play(r.rig);
    const int before = r.watch.activations();
    end(r.rig);
    ASSERT_LE(before, 1);
    ASSERT_EQ(r.watch.activations(), before) << n;
  }
}

// All faults at random, in both directions.
TEST(LossyLink, SurvivesRandomFaults) {
  for (std::uint32_t seed = 0; seed < 150U; ++seed) {
    Rig r;
    std::mt19937 random(seed);
    for (Wire* wire : {&r.rig.to_board(), &r.rig.to_host()}) {
      wire->spoil([&](std::uint64_t, std::uint64_t tick, const Bytes& frame) {
        if (random() % 4U != 0U) {
          return Deliveries{{tick, frame}};
        }
        const Harm& harm = harms()[random() % harms().size()];
        return harm.act(tick, frame, static_cast<std::uint32_t>(random()) % harm.variants);
      });
    }
    play(r.rig);
    const int before = r.watch.activations();
    ASSERT_LE(before, 1) << seed;
    r.rig.to_board().spoil({});
    end(r.rig);
    ASSERT_EQ(r.watch.activations(), before) << seed;
    ASSERT_NE(r.rig.state(), State::kActive) << seed;
  }
}

/// A frame with another session and sequence number, sealed again: the worst a single message can
/// be.
Bytes readdressed(const Bytes& frame, std::uint16_t session, std::uint16_t sequence,
                  bool& is_frame) {
  core::wire::FrameDecoder decoder;
  is_frame = false;
  for (const std::byte byte : frame) {
    if (decoder.push(byte) != core::wire::FrameDecoder::Result::kFrame) {
      continue;
    }
    is_frame = true;
    core::wire::FrameHeader header = decoder.header();
    header.session = session;
    header.sequence = sequence;
    Bytes out(core::wire::kMaxEncodedFrame);
    out.resize(core::wire::encode_frame(header, decoder.payload(), out));
    return out;
  }
  return {};
}

TEST(LossyLink, NeverActivatesOnSingleMessage) {
  for (const Bytes& frame : recorded().frames_to_board) {
    Rig r;
    ASSERT_TRUE(r.rig.open(0).ok());
    bool is_frame = false;
    const Bytes alone = readdressed(frame, r.rig.client().session(), 0x4000, is_frame);
    ASSERT_TRUE(is_frame);
    // Repeated, it is still one message.
    for (int i = 0; i < 5; ++i) {
      r.rig.to_board().send(alone, r.rig.ticks());
      r.rig.settle(30);
    }
    EXPECT_EQ(r.watch.activations(), 0);
  }
}

// Repeats arm with new sequence numbers, as an application that retries.
TEST(LossyLink, IgnoresRepeatedArmAsConfirmation) {
  Rig r;
  ASSERT_TRUE(r.rig.open(0).ok());
  for (int i = 0; i < 10; ++i) {
    (void)r.rig.control(ControlCode::kArm);
    r.rig.settle(20);
  }
  EXPECT_EQ(r.rig.state(), State::kArmed);
  EXPECT_EQ(r.watch.activations(), 0);
}

}  // namespace
}  // namespace tactree::test
