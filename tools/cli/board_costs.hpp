#pragma once
// What a tick costs on a board, by the image of its firmware.

#include <string>
#include <vector>

#include "tactree/bound/bound.hpp"
#include "tactree/core/tick_cost.hpp"
#include "tactree/emulation/emulated_target.hpp"

namespace tactree::cli {

struct BoardCosts {
  bound::BoardTiming timing;
  core::TickCosts costs;
  std::string image;
  bool embedded = false;  ///< by the image itself; else analysed now

  /// Cycles of a tick with this one model, and of the configuration mode, rate and kind of device.
  [[nodiscard]] double cycles(const core::BlobHeader& header,
                              const core::Configuration& configuration) const;
  /// Highest rate the board keeps with it, Hz.
  [[nodiscard]] double highest_rate(const core::BlobHeader& header,
                                    const core::Configuration& configuration) const;
};

/// What is needed to analyse a board's image, but for models and timing. `firmware`: its folder,
/// empty: where it was built or installed.
[[nodiscard]] bound::BoundOptions analysis_of(const emulation::BoardDescription& board,
                                              const std::string& firmware);

/// `firmware`: the folder of its image, empty: where it was built or installed. Throws CommandError
/// on a board that is not known, and what bound and emulation throw.
[[nodiscard]] BoardCosts costs_of_board(const std::string& name, const std::string& firmware = {});

/// A device of the kind that takes longest, or the one of a name or file where one is given.
[[nodiscard]] core::DeviceModel slowest_or(const std::string& device);

/// Boards with a known timing.
[[nodiscard]] std::vector<std::string> boards_with_timing();

}  // namespace tactree::cli
