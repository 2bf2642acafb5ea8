#include "board_costs.hpp"

#include <fmt/core.h>

#include "command.hpp"
#include "tactree/emulation/emulated_target.hpp"

namespace tactree::cli {

double BoardCosts::cycles(const core::BlobHeader& header, core::RenderMode mode) const {
  core::TickLoad load;
  load.add(header, mode);
  return static_cast<double>(core::cycles_of(costs, load));
}

double BoardCosts::highest_rate(const core::BlobHeader& header, core::RenderMode mode) const {
  return timing.clock_hz / cycles(header, mode);
}

BoardCosts costs_of_board(const std::string& name) {
  const emulation::BoardDescription* const board = emulation::find_board(name);
  const bound::BoardTiming* const timing = bound::find_timing(name);
  if (board == nullptr || timing == nullptr) {
    throw CommandError(
        fmt::format("--board: nothing is known about the time that {} takes (choose "
                    "another, or leave it out)",
                    name));
  }
  bound::BoundOptions options;
  options.image = emulation::find_image(*board);
  options.sources = TACTREE_SOURCES;
  options.entries = bound::tick_entries();
  options.timing = timing;
  BoardCosts result{*timing, bound::embedded(options.image), options.image.string(), true};
  if (result.costs.known != core::kTickCostsKnown) {
    result.costs = bound::tick_costs(options);
    result.embedded = false;
  }
  return result;
}

std::vector<std::string> boards_with_timing() {
  std::vector<std::string> names;
  for (const emulation::BoardDescription& board : emulation::boards()) {
    if (bound::find_timing(board.name) != nullptr) {
      names.emplace_back(board.name);
    }
  }
  return names;
}

}  // namespace tactree::cli
