#pragma once
// Two encoders and the switches of a board, at lines of a simulated chip.

#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "gpio_sim.hpp"
#include "tactree/hal/linux/gpio_board.hpp"

namespace tactree::vm_test {

using namespace hal::linux_gpio;

enum Line : std::size_t { kA0, kB0, kA1, kB1, kEnable, kReadBack, kStop, kDeadMan };
inline const std::vector<std::string> kNames = {"encoder0-a", "encoder0-b", "encoder1-a",
                                                "encoder1-b", "enable",     "read-back",
                                                "e-stop",     "dead-man"};
inline const std::vector<EncoderLines> kAxes = {{"encoder0-a", "encoder0-b"},
                                                {"encoder1-a", "encoder1-b"}};

class EncoderWires : public testing::Test {
 protected:
  /// A quarter of a period of an encoder; waits until the board has counted it.
  void turn(std::size_t axis, int direction, GpioEncoderBank& bank) {
    step(axis, direction);
    settle(bank, axis);
  }
  /// An edge: only the line that changes is written.
  void step(std::size_t axis, int direction) {
    const unsigned quarter = static_cast<unsigned>(position_[axis] += direction) & 3U;
    const std::array<bool, 2> levels = {quarter == 1U || quarter == 2U, quarter >= 2U};
    for (std::size_t k = 0; k < 2; ++k) {
      if (levels_[2 * axis + k] != levels[k]) {
        levels_[2 * axis + k] = levels[k];
        chip_.pull(2 * axis + k, levels[k]);
      }
    }
  }
  /// Edges are reported by an interrupt, with a short delay.
  void settle(GpioEncoderBank& bank, std::size_t axis) {
    for (int i = 0; i < 10000 && bank.read().counts[axis] != position_[axis]; ++i) {
      std::this_thread::yield();
    }
  }

  GpioSim chip_{"board", kNames};
  std::array<int, 3> position_{};
  std::array<bool, 4> levels_{};
};

}  // namespace tactree::vm_test
