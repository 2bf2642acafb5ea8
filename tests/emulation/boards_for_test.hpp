#pragma once
// Shared by the tests of emulated boards.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "analytic_shapes.hpp"
#include "folders.hpp"
#include "tactree/emulation/emulated_target.hpp"

namespace tactree::test {

/// The cos sheet of the paper: contact, boundaries and slopes.
inline const Shape& touched_shape() {
  static const Shape shape = cos_sheet();
  return shape;
}

/// A file of the firmware builds; folder: "firmware" or "tests/on_target".
inline std::filesystem::path built(const emulation::BoardDescription& board,
                                   const std::string& folder, const std::string& name) {
  return source_folder() / "build" / board.toolchain / folder / (name + ".elf");
}

/// The firmware of the board without the costs of a tick: it admits every model.
inline std::filesystem::path bare_firmware(const emulation::BoardDescription& board) {
  const std::filesystem::path bare = built(board, "firmware/bare", board.name);
  return std::filesystem::exists(bare) ? bare : built(board, "firmware", board.name);
}

inline std::vector<const emulation::BoardDescription*> all_boards() {
  std::vector<const emulation::BoardDescription*> boards;
  for (const emulation::BoardDescription& board : emulation::boards()) {
    if (board.is_emulated()) {
      boards.push_back(&board);
    }
  }
  return boards;
}

/// A test for each board; skipped if its image is not built.
class OnBoard : public testing::TestWithParam<const emulation::BoardDescription*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(built(board(), "firmware", board().name))) {
      GTEST_SKIP() << "no image for " << board().name;
    }
  }
  [[nodiscard]] static const emulation::BoardDescription& board() { return *GetParam(); }
  [[nodiscard]] static emulation::EmulationOptions options() {
    emulation::EmulationOptions options;
    options.image = bare_firmware(board());
    return options;
  }
};

inline std::string name_of_board(
    const testing::TestParamInfo<const emulation::BoardDescription*>& info) {
  std::string name = info.param->name;
  std::erase(name, '-');
  return name;
}

#define TACTREE_ON_EVERY_BOARD(suite) \
  INSTANTIATE_TEST_SUITE_P(Boards, suite, testing::ValuesIn(all_boards()), name_of_board)

}  // namespace tactree::test
