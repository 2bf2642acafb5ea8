// The whole board of firmware/boards/stm32f405 on the faked chip: the conformance program, and the
// control loop from power-up to a force and back.

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>

#include "analytic_shapes.hpp"
#include "boards/stm32f405/stm32f405_board.hpp"
#include "fake_chip.hpp"
#include "tactree/hal/conformance.hpp"
#include "tactree/hal/loop.hpp"

namespace {

tactree::test::FakeChip* chip = nullptr;
std::span<const std::byte> blob;

}  // namespace

// What an image gets from its core and its linker script.
namespace tactree::firmware {
std::uint32_t deadlines() { return chip->ticks; }
std::uint32_t now_us() { return chip->ticks * 1000U; }
void wait_for_interrupt() { chip->tick(); }
std::span<const std::byte> BlobArea::active() const noexcept { return blob; }
}  // namespace tactree::firmware

namespace tactree::test {
namespace {

using firmware::stm32f4::BootFrame;
using firmware::stm32f4::ClockFailure;
using firmware::stm32f4::CommandFrame;
using firmware::stm32f4::Part;
using Board = firmware::Stm32f405Board<FakeWord>;

static_assert(hal::Board<Board>);

const Shape& touched_shape() {
  static const Shape shape = cos_sheet();
  return shape;
}

class Stm32f405 : public testing::Test {
 protected:
  Stm32f405() {
    ::chip = &fake;
    ::blob = touched_shape().bytes();
  }

  void boot() {
    const ClockFailure clocks = firmware::prepare_chip(fake.chip());
    board = std::make_unique<Board>(fake.chip(), clocks);
    configuration = board->connect({});
    fake.serial.give_ring(&board->ring());  // an address in M0AR has too few bits for the host's
  }

  void send(core::Command command) {
    CommandFrame frame;
    frame.sequence = ++sequence;
    frame.command = command;
    frame.checksum = firmware::stm32f4::checksum_of(frame);
    for (std::size_t i = 0; i < sizeof frame; ++i) {
      fake.serial.arrive(reinterpret_cast<const std::uint8_t*>(&frame)[i]);
    }
  }

  BootFrame boot_frame() {
    BootFrame frame;
    EXPECT_GE(fake.serial.sent.size(), sizeof frame);
    if (fake.serial.sent.size() >= sizeof frame) {
      std::memcpy(&frame, fake.serial.sent.data(), sizeof frame);
      EXPECT_EQ(frame.checksum, firmware::stm32f4::checksum_of(frame));
    }
    return frame;
  }

  [[nodiscard]] double duty() const {
    return fake.tim8.duty(0) + fake.tim8.duty(1) + fake.tim8.duty(2);
  }

  std::string conformance() {
    boot();
    board->report({});
    std::string all;
    const hal::ConformanceReport report = hal::run_conformance(*board);
    for (std::uint32_t i = 0; i < report.failures; ++i) {
      all += std::string(report.failed[i]) + "; ";
    }
    EXPECT_GE(report.checks, 14U);
    return all;
  }

  FakeChip fake;
  std::unique_ptr<Board> board;
  core::Configuration configuration;
  std::uint8_t sequence = 0;
};

TEST_F(Stm32f405, PassesTheConformanceProgram) {
  EXPECT_EQ(conformance(), "");
  EXPECT_FALSE(fake.watchdog.bitten());
  EXPECT_TRUE(fake.watchdog.runs());
  EXPECT_EQ(fake.clocks.violation + fake.serial.violation, "");
}

TEST_F(Stm32f405, AWrongBoardIsFoundOut) {
  fake.power_follows = false;
  fake.hold_dead_man(true);
  fake.gpio_b.wire(14, false);
  const std::string failed = conformance();
  EXPECT_NE(failed.find("the read-back does not follow when the enable line goes on"),
            std::string::npos);
  EXPECT_NE(failed.find("the dead-man control reads as held"), std::string::npos);
  EXPECT_NE(failed.find("the motor bank fails"), std::string::npos);
}

TEST_F(Stm32f405, PinsAreThoseOfTheWiring) {
  boot();
  EXPECT_EQ(fake.gpio_a.mode(15), 2U);
  EXPECT_EQ(fake.gpio_a.function(15), 1U);  // TIM2
  EXPECT_EQ(fake.gpio_b.mode(3), 2U);
  EXPECT_EQ(fake.gpio_b.function(3), 1U);  // TIM2
  for (const std::uint32_t pin : {0U, 1U}) {
    EXPECT_EQ(fake.gpio_a.mode(pin), 2U);
    EXPECT_EQ(fake.gpio_a.function(pin), 2U);  // TIM5
  }
  for (const std::uint32_t pin : {6U, 7U}) {
    EXPECT_EQ(fake.gpio_b.mode(pin), 2U);
    EXPECT_EQ(fake.gpio_b.function(pin), 2U);  // TIM4
  }
  for (const std::uint32_t pin : {6U, 7U, 8U}) {
    EXPECT_EQ(fake.gpio_c.mode(pin), 2U);
    EXPECT_EQ(fake.gpio_c.function(pin), 3U);  // TIM8
  }
  for (const std::uint32_t pin : {9U, 10U}) {
    EXPECT_EQ(fake.gpio_a.mode(pin), 2U);
    EXPECT_EQ(fake.gpio_a.function(pin), 7U);  // USART1
  }
  for (const std::uint32_t pin : {0U, 1U, 2U, 4U}) {
    EXPECT_EQ(fake.gpio_c.mode(pin), 1U);
  }
}

TEST_F(Stm32f405, EachPartThatDoesNotStartIsToldAndThereIsNoForce) {
  const std::pair<std::uint8_t, void (*)(FakeChip&)> cases[] = {
      {1U << 0, [](FakeChip& f) { f.tim4.gate_by([] { return false; }); }},
      {1U << 1, [](FakeChip& f) { f.tim8.gate_by([] { return false; }); }},
      {1U << 2, [](FakeChip& f) { f.gpio_c.gate_by([] { return false; }); }},
      {1U << 3, [](FakeChip& f) { f.gpio_b.gate_by([] { return false; }); }},
      {1U << 4, [](FakeChip& f) { f.watchdog.takes_settings = false; }},
  };
  for (const auto& [part, break_it] : cases) {
    FakeChip broken;
    break_it(broken);
    ::chip = &broken;
    Board other(broken.chip(), firmware::prepare_chip(broken.chip()));
    (void)other.connect({});
    other.report({});
    EXPECT_FALSE(other.motors().healthy());
    for (int i = 0; i < 200; ++i) {
      (void)other.ticker().wait();
      other.link().send(core::Status{});
    }
    BootFrame frame;
    ASSERT_GE(broken.serial.sent.size(), sizeof frame);
    std::memcpy(&frame, broken.serial.sent.data(), sizeof frame);
    EXPECT_EQ(frame.failed_parts, part);
  }
}

TEST_F(Stm32f405, WithoutItsCrystalItTellsAndGivesNoForce) {
  fake.clocks.crystal_MHz = 0;
  boot();
  board->report({});
  for (int i = 0; i < 200; ++i) {
    (void)board->ticker().wait();
    board->link().send(core::Status{});
  }
  EXPECT_EQ(boot_frame().clocks, ClockFailure::kCrystal);
  EXPECT_FALSE(board->motors().healthy());
  EXPECT_NEAR(fake.serial.baud(), 115200.0, 1152.0) << "nobody could read it";
}

TEST_F(Stm32f405, ALoopThatHangsStarvesTheWatchdog) {
  boot();
  board->report({});
  for (int i = 0; i < 100; ++i) {
    (void)board->ticker().wait();
  }
  EXPECT_FALSE(fake.watchdog.bitten());
  for (int i = 0; i < 10; ++i) {
    fake.tick();
  }
  EXPECT_TRUE(fake.watchdog.bitten());
}

// From power-up over homing and arming to a force; then the emergency stop.
TEST_F(Stm32f405, HoldsTheWeightOfItsDeviceAndLetsGo) {
  boot();
  core::Controller controller;
  hal::Loop<Board> loop(*board, controller);
  const hal::StartResult started = loop.start(configuration);
  ASSERT_TRUE(started.ok());
  board->report(started);

  core::Status status;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      if (i % 20 == 0) {
        send(core::Command::kNone);
      }
      status = loop.tick().status;
    }
  };
  run(5);
  send(core::Command::kHome);
  run(5);
  EXPECT_EQ(duty(), 0.0);
  send(core::Command::kArm);
  run(5);
  fake.hold_dead_man(true);
  run(2000);
  EXPECT_EQ(status.state, core::State::kActive) << "faults " << status.faults;
  EXPECT_FALSE(fake.watchdog.bitten());

  // The arm's own weight alone moves the motors; then the stop.
  EXPECT_GT(duty(), 0.0);
  fake.press_stop(true);
  run(2);
  EXPECT_EQ(duty(), 0.0);
  EXPECT_EQ(status.state, core::State::kFault);
  EXPECT_FALSE(fake.gpio_c.level(4)) << "the amplifiers keep their power";
  EXPECT_EQ(fake.serial.violation, "");
}

}  // namespace
}  // namespace tactree::test
