// The whole board of firmware/boards/stm32f405 on the faked chip, with an application at its serial
// port: from power-up to force and back, and every refusal.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>

#include "analytic_shapes.hpp"
#include "board_rig.hpp"
#include "tactree/client/board.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/hal/conformance.hpp"

// Functions and symbols that an image gets from core and linker script.
namespace tactree::firmware {
std::uint32_t deadlines() { return test::chip_in_use.chip->ticks; }
std::uint32_t now_us() { return test::chip_in_use.chip->ticks * 1000U; }
void hold_ticks(bool hold) {
  test::chip_in_use.ticks_held = hold;
  if (hold) {
    test::chip_in_use.on_hold();
  }
}
void wait_for_interrupt() { test::chip_in_use.chip->tick(); }
std::span<const std::byte> BlobArea::active() const noexcept {
  constexpr std::size_t kRoom = 896U * 1024U;
  const std::byte* const begin =
      test::chip_in_use.chip->flash.whole().bytes + test::BoardRig::kBlobBegin;
  const auto& header = *reinterpret_cast<const core::BlobHeader*>(begin);
  return {begin, std::min<std::size_t>(header.total_bytes, kRoom)};
}
}  // namespace tactree::firmware

namespace tactree::test {
namespace {

using core::wire::ControlCode;
using core::wire::MessageKind;
using core::wire::StartPart;
using core::wire::WireStatus;
using Board = BoardRig::Board;

static_assert(hal::Board<Board>);

/// The one of the image, and the one that an application writes.
const Shape& image_model() {
  static const Shape shape = sheet_below_hand();
  return shape;
}
/// A ball below the hand.
const Shape& other_model() {
  static const Shape shape = [] {
    Shape ball = sphere();
    for (Eigen::Vector3d& point : ball.model().positions) {
      point.z() -= 2.0 * kSphereRadius;
    }
    ball.seal();
    return ball;
  }();
  return shape;
}

std::uint32_t bit(StartPart part) { return static_cast<std::uint32_t>(part); }

class Stm32f405 : public testing::Test {
 protected:
  Stm32f405() { rig.program_image_model(image_model().bytes()); }
  ~Stm32f405() override {
    FakeChip& chip = rig.chip();
    EXPECT_EQ(chip.clocks.violation + chip.serial.violation + chip.flash.violation, "");
  }

  std::string conformance() {
    rig.boot();
    std::string all;
    const hal::ConformanceReport report = hal::run_conformance(rig.board());
    for (std::uint32_t i = 0; i < report.failures; ++i) {
      all += std::string(report.failed[i]) + "; ";
    }
    EXPECT_GE(report.checks, 14U);
    return all;
  }

  [[nodiscard]] bool uses(const Shape& model) {
    const auto active = rig.board().storage().active();
    return std::ranges::equal(active, model.bytes());
  }
  [[nodiscard]] core::wire::ListModelsReply models() {
    core::wire::ListModelsReply reply;
    (void)rig.ask(MessageKind::kListModels).read(reply);
    return reply;
  }

  BoardRig rig;
};

TEST_F(Stm32f405, PassesConformanceProgram) {
  EXPECT_EQ(conformance(), "");
  EXPECT_FALSE(rig.chip().watchdog.bitten());
  EXPECT_TRUE(rig.chip().watchdog.runs());
}

TEST_F(Stm32f405, DetectsDefectiveBoard) {
  rig.chip().power_follows = false;
  rig.chip().hold_dead_man(true);
  rig.chip().gpio_b.wire(14, false);
  const std::string failed = conformance();
  EXPECT_NE(failed.find("the read-back does not follow when the enable line goes on"),
            std::string::npos);
  EXPECT_NE(failed.find("the dead-man control reads as held"), std::string::npos);
  EXPECT_NE(failed.find("the motor bank fails"), std::string::npos);
}

TEST_F(Stm32f405, ConfiguresWiredPins) {
  rig.boot();
  EXPECT_EQ(rig.chip().gpio_a.mode(15), 2U);
  EXPECT_EQ(rig.chip().gpio_a.function(15), 1U);  // TIM2
  EXPECT_EQ(rig.chip().gpio_b.mode(3), 2U);
  EXPECT_EQ(rig.chip().gpio_b.function(3), 1U);  // TIM2
  for (const std::uint32_t pin : {0U, 1U}) {
    EXPECT_EQ(rig.chip().gpio_a.mode(pin), 2U);
    EXPECT_EQ(rig.chip().gpio_a.function(pin), 2U);  // TIM5
  }
  for (const std::uint32_t pin : {6U, 7U}) {
    EXPECT_EQ(rig.chip().gpio_b.mode(pin), 2U);
    EXPECT_EQ(rig.chip().gpio_b.function(pin), 2U);  // TIM4
  }
  for (const std::uint32_t pin : {6U, 7U, 8U}) {
    EXPECT_EQ(rig.chip().gpio_c.mode(pin), 2U);
    EXPECT_EQ(rig.chip().gpio_c.function(pin), 3U);  // TIM8
  }
  for (const std::uint32_t pin : {9U, 10U}) {
    EXPECT_EQ(rig.chip().gpio_a.mode(pin), 2U);
    EXPECT_EQ(rig.chip().gpio_a.function(pin), 7U);  // USART1
  }
  for (const std::uint32_t pin : {0U, 1U, 2U, 4U}) {
    EXPECT_EQ(rig.chip().gpio_c.mode(pin), 1U);
  }
}

TEST_F(Stm32f405, ReportsEachFailedPart) {
  const std::pair<StartPart, void (*)(FakeChip&)> cases[] = {
      {StartPart::kEncoders, [](FakeChip& f) { f.tim4.gate_by([] { return false; }); }},
      {StartPart::kMotors, [](FakeChip& f) { f.tim8.gate_by([] { return false; }); }},
      {StartPart::kEnableLine, [](FakeChip& f) { f.gpio_c.gate_by([] { return false; }); }},
      {StartPart::kSafetyInputs, [](FakeChip& f) { f.gpio_b.gate_by([] { return false; }); }},
      {StartPart::kWatchdog, [](FakeChip& f) { f.watchdog.takes_settings = false; }},
      {StartPart::kReceiver,
       [](FakeChip& f) { f.serial.gate_by([] { return true; }, [] { return false; }); }},
      {StartPart::kCrystal, [](FakeChip& f) { f.clocks.crystal_MHz = 0; }},
      {StartPart::kCrystalFrequency, [](FakeChip& f) { f.clocks.soldered_MHz = 8.0; }},
      {StartPart::kWaitStates, [](FakeChip& f) { f.clocks.flash_takes_wait_states = false; }},
      {StartPart::kPll, [](FakeChip& f) { f.clocks.pll_locks = false; }},
      {StartPart::kClockSwitch, [](FakeChip& f) { f.clocks.switch_works = false; }},
  };
  for (const auto& [part, break_it] : cases) {
    BoardRig broken;
    broken.program_image_model(image_model().bytes());
    break_it(broken.chip());
    broken.boot();
    const core::wire::ReadStartReply start = broken.ask_start();
    EXPECT_EQ(broken.chip().serial.baud(), 1e6) << "the link is unusable";
    EXPECT_EQ(start.missing, bit(part));
    EXPECT_EQ(start.blob, 0U);
    EXPECT_FALSE(broken.board().motors().healthy());
    EXPECT_FALSE(broken.arm()) << bit(part);
    EXPECT_EQ(broken.duty(), 0.0);
  }
}

TEST_F(Stm32f405, ReportsCauseOfLastReset) {
  rig.chip().clocks.rcc.csr.value = 1U << 29;
  rig.boot({3, 4, 5, 0x0800D000, 7, 8, {}});
  const core::wire::ReadStartReply start = rig.ask_start();
  EXPECT_EQ(start.by_watchdog, 1U);
  EXPECT_EQ(start.fault_cause, 3U);
  EXPECT_EQ(start.fault_pc, 0x0800D000U);
  rig.restart();
  EXPECT_EQ(rig.ask_start().by_watchdog, 0U);
  EXPECT_EQ(rig.ask_start().missing, 0U);
}

TEST_F(Stm32f405, ReportsInvalidModel) {
  std::vector<std::byte> flipped(image_model().bytes().begin(), image_model().bytes().end());
  flipped[flipped.size() / 2] ^= std::byte{4};
  rig.program_image_model(flipped);
  rig.boot();
  EXPECT_EQ(rig.ask_start().blob, static_cast<std::uint8_t>(core::BlobStatus::kBadChecksum));
  EXPECT_FALSE(rig.arm());
}

TEST_F(Stm32f405, ReportsRefusedProgramWithItsLamp) {
  rig.image = hal::ImageStatus::kDamaged;
  rig.boot();
  std::string lamp;
  for (int slot = 0; slot < 20; ++slot) {
    rig.run(50);
    lamp += rig.chip().gpio_c.level(3) ? '#' : '.';
    rig.run(50);
  }
  EXPECT_EQ(lamp, "#.#.#...............");
  EXPECT_EQ(rig.ask_start().image, static_cast<std::uint8_t>(hal::ImageStatus::kDamaged));
  EXPECT_FALSE(rig.arm_by_button());
}

TEST_F(Stm32f405, TriggersWatchdogOnBlockedLoop) {
  rig.boot();
  rig.run(100);
  EXPECT_FALSE(rig.chip().watchdog.bitten());
  rig.ticks_run = false;
  rig.run(10);
  EXPECT_TRUE(rig.chip().watchdog.bitten());
}

TEST_F(Stm32f405, IdentifiesItself) {
  rig.boot();
  core::wire::IdentifyReply who;
  ASSERT_TRUE(rig.ask(MessageKind::kIdentify).read(who));
  EXPECT_STREQ(who.board, "stm32f405");
  ASSERT_TRUE(rig.open().ok());
  core::wire::CapabilitiesReply can;
  ASSERT_TRUE(rig.ask(MessageKind::kCapabilities).read(can));
  EXPECT_EQ(can.slots, 2U);
  EXPECT_EQ(can.slot_bytes, 3U * 131072U);
  EXPECT_EQ(can.cycles_per_tick, 168000U);
}

// From power-up over homing and arming to a touch; then the emergency stop.
TEST_F(Stm32f405, CompensatesWeightUntilEmergencyStop) {
  rig.boot();
  ASSERT_TRUE(rig.started().ok());
  EXPECT_EQ(rig.duty(), 0.0);
  ASSERT_TRUE(rig.arm()) << "faults " << rig.status().faults;
  EXPECT_FALSE(rig.chip().watchdog.bitten());

  // The arm's own weight alone moves the motors; then the model, and the stop.
  EXPECT_GT(rig.duty(), 0.0);
  EXPECT_FALSE(rig.feels());
  EXPECT_TRUE(rig.touch());
  rig.chip().press_stop(true);
  rig.run(2);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().state, core::State::kFault);
  EXPECT_FALSE(rig.chip().gpio_c.level(4)) << "the amplifiers keep their power";
}

core::Vec3 vector_of(const float (&from)[3]) { return {from[0], from[1], from[2]}; }

// From the encoders to the pins of the motors, and to the telemetry of an application.
TEST_F(Stm32f405, StatesTheForceThatItsPinsShow) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  client::Telemetry told;
  rig.client().on_telemetry([&](const client::Telemetry& t) { told = t; });
  ASSERT_TRUE(
      rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{core::wire::kAllTelemetry, 10})
          .ok());
  for (const bool touching : {false, true}) {
    ASSERT_EQ(touching && rig.touch(), touching);
    rig.run(500);
    const core::Status& status = rig.status();
    EXPECT_GT(core::length(status.gravity_force), 0.02F);
    EXPECT_EQ(core::length(status.force) > 0.3F, touching);
    // A step of the pulse width is 3 mN at the probe.
    EXPECT_LT(core::length(rig.force_at_pins() - status.motor_force), 0.01F);
    EXPECT_LT(core::length(status.motor_force - status.force - status.gravity_force), 1e-4F);
    EXPECT_GT(told.header.tick + 100U, status.tick) << "telemetry has ended";
    EXPECT_LT(core::length(vector_of(told.gravity_N) - status.gravity_force), 1e-4F);
    EXPECT_LT(core::length(vector_of(told.motors_N) - status.motor_force), 1e-2F);
  }
}

// The image as it is built: at most 0.5 N, whatever the signs are.
TEST_F(Stm32f405, GivesFirstForceUntilSignsAreProven) {
  rig.signs_proven = false;
  rig.boot();
  const core::Configuration& configuration = rig.configuration();
  EXPECT_FALSE(configuration.motors.signs_proven);
  EXPECT_FALSE(configuration.compensate_gravity);
  EXPECT_EQ(configuration.limits.force_max_N, core::kFirstForce_N);
  ASSERT_TRUE(rig.arm()) << "faults " << rig.status().faults;
  EXPECT_EQ(rig.duty(), 0.0) << "in free space";
  EXPECT_TRUE(rig.touch());
  EXPECT_LE(core::length(rig.status().motor_force), 1.0001F * core::kFirstForce_N);
}

TEST_F(Stm32f405, RefusesForceWithBrokenButtonPort) {
  rig.chip().gpio_b.gate_by([] { return false; });
  rig.boot();
  rig.run(100);
  EXPECT_FALSE(rig.arm_by_button());
}

TEST_F(Stm32f405, StopsOnRequest) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(rig.control(ControlCode::kStop).ok());
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().state, core::State::kIdle);
  EXPECT_FALSE(rig.chip().gpio_c.level(4));
}

TEST_F(Stm32f405, EndsForceForSilentApplication) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(rig.touch());
  rig.run(1000);
  EXPECT_EQ(rig.status().state, core::State::kActive);
  rig.application_runs = false;
  rig.run(30);
  EXPECT_TRUE(rig.feels());
  rig.run(25);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_EQ(rig.status().faults, core::fault_bit(core::Fault::kLinkLost));
}

// Telemetry of ten times the port's bandwidth does not block replies.
TEST_F(Stm32f405, KeepsLinkResponsiveUnderTelemetry) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  ASSERT_TRUE(rig.ask(MessageKind::kSubscribe, core::wire::SubscribeRequest{0x3FF, 1}).ok());
  rig.run(2000);
  EXPECT_EQ(rig.status().state, core::State::kActive) << rig.status().faults;
  ASSERT_TRUE(rig.control(ControlCode::kStop).ok());
}

// ---- models and parameters

TEST_F(Stm32f405, StoresAnotherModel) {
  rig.boot();
  EXPECT_TRUE(uses(image_model()));
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.flash(other_model().bytes()).ok());
  EXPECT_FALSE(rig.chip().watchdog.bitten());
  EXPECT_EQ(rig.status().faults, 0U);
  EXPECT_TRUE(uses(other_model()));
  rig.restart();
  EXPECT_TRUE(rig.started().ok());
  EXPECT_TRUE(uses(other_model()));
  ASSERT_TRUE(rig.arm());
  EXPECT_GT(rig.duty(), 0.0);
}

TEST_F(Stm32f405, OverwritesUnusedImageModelOnly) {
  // So large that it reaches into the first slot: as one of more than 128 KiB does.
  const Shape large = cos_sheet({}, 0.04, 0.0004);
  ASSERT_GT(large.bytes().size(), 0x20000U);
  ASSERT_LE(large.bytes().size(), 0x80000U);
  rig.program_image_model(large.bytes());
  rig.boot();
  ASSERT_TRUE(rig.started().ok());
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.flash(other_model().bytes()).ok());
  EXPECT_EQ(models().slot[1].state, static_cast<std::uint8_t>(core::wire::SlotState::kActive));
  ASSERT_TRUE(rig.flash(image_model().bytes()).ok());
  EXPECT_EQ(models().slot[0].state, static_cast<std::uint8_t>(core::wire::SlotState::kActive));
  rig.restart();
  EXPECT_TRUE(uses(image_model()));
}

TEST_F(Stm32f405, RefusesModelWhileForcePossible) {
  rig.boot();
  ASSERT_TRUE(rig.arm());
  EXPECT_EQ(rig.flash(other_model().bytes()).status, WireStatus::kBusy);
  EXPECT_EQ(rig.ask(MessageKind::kSaveParameters).status, WireStatus::kBusy);
  EXPECT_EQ(rig.chip().flash.operations, 0U);
  EXPECT_EQ(rig.status().state, core::State::kActive);
}

TEST_F(Stm32f405, ErasesUnpoweredWithExtendedWatchdog) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  // The power is on, as if the last tick had gone wrong.
  chip_in_use.on_hold = [&] { rig.chip().gpio_c.block.odr.value |= 1U << 4; };
  std::uint32_t seen = 0;
  const auto pass = rig.chip().flash.pass;
  rig.chip().flash.pass = [&](double us) {
    if (us == FakeFlash::kEraseUs) {
      ++seen;
      EXPECT_TRUE(chip_in_use.ticks_held);
      EXPECT_FALSE(rig.chip().gpio_c.level(4));
      EXPECT_EQ(rig.duty(), 0.0);
    }
    pass(us);
  };
  ASSERT_TRUE(rig.flash(other_model().bytes()).ok());
  EXPECT_GE(seen, 1U);
  EXPECT_FALSE(rig.chip().watchdog.bitten()) << "the timeout was not extended for the erase";
  EXPECT_FALSE(chip_in_use.ticks_held);

  rig.ticks_run = false;
  rig.run(10);
  EXPECT_TRUE(rig.chip().watchdog.bitten()) << "the timeout was not restored";
}

TEST_F(Stm32f405, RefusesEraseWithoutExtendedWatchdog) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  rig.chip().watchdog.takes_settings = false;
  EXPECT_EQ(rig.flash(other_model().bytes()).status, WireStatus::kStorageFailed);
  EXPECT_EQ(rig.chip().flash.erased, 0U);
}

TEST_F(Stm32f405, RefusesForceUnderExtendedWatchdog) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  const auto pass = rig.chip().flash.pass;
  rig.chip().flash.pass = [&](double us) {
    rig.chip().watchdog.takes_settings = false;
    pass(us);
  };
  ASSERT_TRUE(rig.flash(other_model().bytes()).ok());
  EXPECT_EQ(rig.ask_start().missing, bit(StartPart::kWatchdog));
  EXPECT_FALSE(rig.arm());
  EXPECT_NE(rig.status().faults & core::fault_bit(core::Fault::kMotorFault), 0U);
  EXPECT_EQ(rig.duty(), 0.0);
}

// At every erase, around it, and at every word of the records.
TEST_F(Stm32f405, SurvivesPowerCutDuringUpdate) {
  const Shape large = cos_sheet({}, 0.04, 0.0004);  // of several sectors
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  ASSERT_TRUE(rig.flash(other_model().bytes()).ok());
  const std::vector<std::uint32_t> before = rig.chip().flash.content();
  const std::uint64_t begin = rig.chip().flash.operations;
  ASSERT_TRUE(rig.flash(large.bytes()).ok());
  const std::uint64_t all = rig.chip().flash.operations - begin;
  const std::uint64_t erases = rig.chip().flash.erased - 1U;
  ASSERT_GE(erases, 2U);

  std::vector<std::uint64_t> cuts;
  for (std::uint64_t i = 0; i < erases + 3U; ++i) {
    cuts.push_back(i);
  }
  for (std::uint64_t i = all - 2U * store::kRecordBytes / 4U - 3U; i < all; i += 17U) {
    cuts.push_back(i);
  }
  cuts.push_back(all - 1U);
  std::uint32_t new_ones = 0;
  for (const std::uint64_t cut : cuts) {
    BoardRig other;
    other.chip().flash.restore(before);
    other.boot();
    ASSERT_TRUE(other.open().ok());
    other.chip().flash.power_goes_at = cut;
    (void)other.flash(large.bytes());
    other.restart();
    ASSERT_TRUE(other.started().ok()) << cut;
    const auto active = other.board().storage().active();
    const bool is_old = std::ranges::equal(active, other_model().bytes());
    const bool is_new = std::ranges::equal(active, large.bytes());
    ASSERT_TRUE(is_old || is_new) << cut;
    new_ones += is_new ? 1U : 0U;
  }
  EXPECT_LE(new_ones, 1U) << "a record was used before it was complete";
}

TEST_F(Stm32f405, StoresItsCalibration) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  core::wire::ParameterReply reply;
  ASSERT_TRUE(rig.ask(MessageKind::kGetParameter, core::wire::GetParameterRequest{0}).read(reply));
  const float value = 0.5F * (reply.value + reply.max);
  ASSERT_NE(value, reply.value);
  ASSERT_TRUE(rig.ask(MessageKind::kSetParameter, core::wire::SetParameterRequest{0, value}).ok());
  ASSERT_TRUE(rig.ask(MessageKind::kSaveParameters).ok());
  rig.restart();
  EXPECT_EQ(core::parameter_of(rig.configuration(), 0), value);
  EXPECT_TRUE(uses(image_model()));
}

TEST_F(Stm32f405, ErasesFullRecordSectors) {
  rig.boot();
  ASSERT_TRUE(rig.open().ok());
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(rig.ask(MessageKind::kSaveParameters).ok()) << i;
  }
  EXPECT_GE(rig.chip().flash.erased, 2U);
  EXPECT_FALSE(rig.chip().watchdog.bitten());
  EXPECT_EQ(rig.status().faults, 0U);
  rig.restart();
  EXPECT_TRUE(uses(image_model()));
}

// ---- the library of applications

/// The wire between that and the board, which runs in the library's thread, in lock-step with it.
/// The hand holds on a moment after the board is armed.
class RigTransport : public client::Transport {
 public:
  /// `driven`: whether the motors ever got current.
  RigTransport(BoardRig& rig, std::atomic<bool>& driven) : rig_(rig), driven_(driven) {
    rig_.application_runs = false;
  }

  std::size_t read(std::span<std::byte> bytes) override {
    const std::vector<std::uint8_t> sent = rig_.take_sent();
    waiting_.insert(waiting_.end(), sent.begin(), sent.end());
    const std::size_t count = std::min(bytes.size(), waiting_.size());
    for (std::size_t i = 0; i < count; ++i) {
      bytes[i] = std::byte{waiting_.front()};
      waiting_.pop_front();
    }
    return count;
  }
  std::size_t write(std::span<const std::byte> bytes) override {
    for (const std::byte byte : bytes) {
      rig_.to_board().push_back(static_cast<std::uint8_t>(byte));
    }
    return bytes.size();
  }
  void wait(std::chrono::microseconds timeout) override {
    for (due_ += timeout; due_ >= kTick; due_ -= kTick) {
      ticked_us_ += kTick.count();
      const core::State state = rig_.controller().state();
      const bool armed = state == core::State::kArmed || state == core::State::kActive;
      armed_ticks_ = armed ? armed_ticks_ + 1 : 0;
      rig_.chip().hold_dead_man(armed_ticks_ > 20);
      rig_.tick();
      driven_ = driven_ || rig_.duty() > 0.0;
    }
  }
  [[nodiscard]] std::chrono::microseconds now() const override {
    return std::chrono::microseconds(ticked_us_);
  }
  [[nodiscard]] bool in_lock_step() const override { return true; }
  [[nodiscard]] bool connected() const override { return true; }
  [[nodiscard]] std::string name() const override { return "the serial port"; }

 private:
  static constexpr std::chrono::microseconds kTick{1000};

  BoardRig& rig_;
  std::atomic<bool>& driven_;
  int armed_ticks_ = 0;
  std::deque<std::uint8_t> waiting_;
  std::chrono::microseconds due_{0};
  std::atomic<std::int64_t> ticked_us_ = 0;
};

TEST(Stm32f405InLockStep, ServesClientLibrary) {
  const Shape small = cos_sheet({}, 0.04, 0.002);
  BoardRig rig;
  rig.program_image_model(image_model().bytes());
  rig.boot();
  std::atomic<bool> driven = false;
  {
    const client::Introduction found =
        client::Board::introduce(std::make_unique<RigTransport>(rig, driven));
    EXPECT_STREQ(found.board.board, "stm32f405");
    EXPECT_TRUE(client::complaints(found.start).empty());
  }
  {
    client::BoardOptions options;
    options.link_timeout_ms = 100;
    client::Board board(std::make_unique<RigTransport>(rig, driven), options);
    board.flash({.bytes = small.bytes(), .board = "stm32f405"});
    EXPECT_EQ(board.models().slot[0].state,
              static_cast<std::uint8_t>(core::wire::SlotState::kActive));
    board.set_parameter("delay_s", 0.0005F);
    board.save_parameters();
    board.home();
    board.arm();
    EXPECT_THROW(board.flash({.bytes = small.bytes(), .board = ""}), client::LinkError);
    EXPECT_EQ(static_cast<core::State>(board.state().state), core::State::kActive);
    board.stop();
    EXPECT_EQ(static_cast<core::State>(board.state().state), core::State::kIdle);
    EXPECT_FALSE(board.trace().empty());
  }
  EXPECT_TRUE(driven);
  EXPECT_EQ(rig.duty(), 0.0);
  EXPECT_FALSE(rig.chip().watchdog.bitten());
}

}  // namespace
}  // namespace tactree::test
