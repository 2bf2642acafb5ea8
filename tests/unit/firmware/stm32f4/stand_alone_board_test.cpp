// A board that stands alone, on the faked chip of the stm32f405, whose pins, timers and watchdog it
// has: from power-up to force and the emergency stop, by button, dead-man control and lamp.

#include "stm32f4/stand_alone_board.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>

#include "../boards/stm32f405/board_rig.hpp"
#include "analytic_shapes.hpp"
#include "tactree/hal/conformance.hpp"

namespace tactree::test {
namespace {

using firmware::wiring::LinkUse;
using AloneBoard = firmware::stm32f4::StandAloneBoard<FakeWord>;
static_assert(hal::Board<AloneBoard>);

class StandAloneBoard : public testing::Test {
 protected:
  StandAloneBoard() : shape_(sheet_below_hand()) {
    chip_in_use = {&chip_};
    chip_.flash.put(BoardRig::kBlobBegin, shape_.bytes());
  }
  ~StandAloneBoard() override { chip_in_use = {}; }

  /// From reset to the first tick, as main.cpp does it.
  void boot(bool with_clocks = true) {
    if (with_clocks) {
      (void)firmware::prepare_chip(chip_.chip());
    }
    board_ = std::make_unique<AloneBoard>(
        firmware::stm32f4::StandAloneChip<FakeWord>{
            chip_.gpio_a.block, chip_.gpio_b.block, chip_.gpio_c.block, chip_.tim2.block,
            chip_.tim4.block, chip_.tim5.block, chip_.tim8.block, chip_.watchdog.block},
        firmware::wiring::kEffortAtFullWidth);
    const core::Configuration configuration =
        board_->start(firmware::wiring::configuration(LinkUse::kOperates, signs_proven));
    EXPECT_FALSE(configuration.link.may_command);
    loop_.emplace(*board_, controller_);
    start_.image = image;
    if (image == hal::ImageStatus::kOk) {
      start_ = loop_->start(configuration);
    }
    board_->report(start_);
  }

  core::State run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      status_ = loop_->tick().status;  // waits until the chip's next deadline
    }
    return status_.state;
  }
  /// The hand presses on the model, and stays there; true if the motors press back.
  bool touch() {
    hand_.move(chip_, kOnSheetBelowHand, [this] { run(1); });
    run(300);
    return status_.rendering.in_contact && status_.force.z > 0.0F && duty() > 0.0;
  }
  void press_button() {
    chip_.press_button(true);
    run(1100);
    chip_.press_button(false);
    run(50);
  }
  [[nodiscard]] double duty() {
    return chip_.tim8.duty(0) + chip_.tim8.duty(1) + chip_.tim8.duty(2);
  }

  hal::ImageStatus image = hal::ImageStatus::kOk;
  bool signs_proven = true;
  Shape shape_;
  FakeChip chip_;
  FakeHand hand_{firmware::wiring::configuration().device};
  core::Status status_;
  core::Controller controller_;
  std::unique_ptr<AloneBoard> board_;
  std::optional<hal::Loop<AloneBoard>> loop_;
  hal::StartResult start_;
};

TEST_F(StandAloneBoard, PassesConformanceProgram) {
  boot();
  EXPECT_TRUE(start_.ok());
  const hal::ConformanceReport report = hal::run_conformance(*board_);
  std::string failed;
  for (std::uint32_t i = 0; i < report.failures; ++i) {
    failed += std::string(report.failed[i]) + "; ";
  }
  EXPECT_EQ(failed, "");
  EXPECT_TRUE(chip_.watchdog.runs());
  EXPECT_FALSE(chip_.watchdog.bitten());
}

TEST_F(StandAloneBoard, IsOperatedByItsButtonUntilEmergencyStop) {
  boot();
  ASSERT_TRUE(start_.ok());
  EXPECT_EQ(run(50), core::State::kIdle);
  press_button();  // homes
  press_button();  // arms
  EXPECT_TRUE(chip_.gpio_c.level(4)) << "the amplifiers have power";
  chip_.hold_dead_man(true);
  EXPECT_EQ(run(500), core::State::kActive);
  EXPECT_TRUE(chip_.gpio_c.level(3)) << "the lamp is on";
  EXPECT_FALSE(status_.rendering.in_contact);
  EXPECT_TRUE(touch()) << "force " << status_.force.z;
  chip_.press_stop(true);
  EXPECT_EQ(run(2), core::State::kFault);
  EXPECT_FALSE(chip_.gpio_c.level(4));
  run(1);
  EXPECT_EQ(duty(), 0.0);
}

TEST_F(StandAloneBoard, GivesFirstForceUntilSignsAreProven) {
  signs_proven = false;
  boot();
  run(50);
  press_button();
  press_button();
  chip_.hold_dead_man(true);
  EXPECT_EQ(run(500), core::State::kActive);
  EXPECT_EQ(duty(), 0.0) << "in free space";
  EXPECT_TRUE(touch());
  EXPECT_LE(core::length(status_.motor_force), 1.0001F * core::kFirstForce_N);
}

// The lamp in slots of 0.1 s: three flashes, where a board without a model has two.
TEST_F(StandAloneBoard, ShowsThatItsProgramIsRefused) {
  image = hal::ImageStatus::kBadMemory;
  boot();
  std::string lamp;
  for (int slot = 0; slot < 20; ++slot) {
    run(50);
    lamp += chip_.gpio_c.level(3) ? '#' : '.';
    run(50);
  }
  EXPECT_EQ(lamp, "#.#.#...............");
  press_button();
  EXPECT_FALSE(chip_.gpio_c.level(4)) << "the amplifiers have power";
}

TEST_F(StandAloneBoard, KeepsMotorsOffWithoutClocks) {
  boot(false);
  EXPECT_FALSE(board_->motors().healthy());
  EXPECT_TRUE(board_->safety_inputs().emergency_stop());
  EXPECT_FALSE(board_->safety_inputs().dead_man());
}

}  // namespace
}  // namespace tactree::test
