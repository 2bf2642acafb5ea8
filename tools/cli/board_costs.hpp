#pragma once
// What a tick costs on a board, by the image of its firmware.

#include <string>
#include <vector>

#include "tactree/bound/bound.hpp"
#include "tactree/core/tick_cost.hpp"

namespace tactree::cli {

struct BoardCosts {
  bound::BoardTiming timing;
  core::TickCosts costs;
  std::string image;
  bool embedded = false;  ///< by the image itself; else analysed now

  /// Cycles of a tick with this one model.
  [[nodiscard]] double cycles(const core::BlobHeader& header, core::RenderMode mode) const;
  /// Highest rate the board keeps with it, Hz.
  [[nodiscard]] double highest_rate(const core::BlobHeader& header, core::RenderMode mode) const;
};

/// Throws CommandError on a board that is not known, and what bound and emulation throw.
[[nodiscard]] BoardCosts costs_of_board(const std::string& name);

/// Boards with a known timing.
[[nodiscard]] std::vector<std::string> boards_with_timing();

}  // namespace tactree::cli
