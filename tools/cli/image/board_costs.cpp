#include "image/board_costs.hpp"

#include <fmt/core.h>

#include <optional>

#include "image/own_board.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {

wcet::WorkTierCycles BoardCosts::cycles_at_tiers(const core::BlobHeader& header,
                                                 const core::Configuration& configuration) const {
  core::TickLoad load;
  load.add(header, configuration);
  wcet::WorkTierCycles cycles{};
  for (load.work_tier = 0; load.work_tier < core::kWorkTiers; ++load.work_tier) {
    cycles[load.work_tier] = static_cast<double>(core::cycles_of(costs, load));
  }
  return cycles;
}

std::uint32_t BoardCosts::work_tier(const core::BlobHeader& header,
                                    const core::Configuration& configuration) const {
  return wcet::work_tier_in_time(static_cast<double>(configuration.rate_hz), timing.clock_hz,
                                 cycles_at_tiers(header, configuration));
}

double BoardCosts::cycles(const core::BlobHeader& header,
                          const core::Configuration& configuration) const {
  return cycles_at_tiers(header, configuration)[work_tier(header, configuration)];
}

double BoardCosts::highest_rate(const core::BlobHeader& header,
                                const core::Configuration& configuration) const {
  return wcet::highest_rate(timing.clock_hz, cycles_at_tiers(header, configuration));
}

std::string source_folder() { return TACTREE_SOURCES; }

wcet::BoundOptions analysis_of(const emulation::BoardDescription& board,
                               const std::string& firmware) {
  wcet::BoundOptions options;
  options.image = emulation::find_image(board, firmware);
  options.sources = {source_folder()};
  options.entries = wcet::tick_entries();
  return options;
}

namespace {

/// The costs in the image, or those of an analysis.
BoardCosts costs_of(const wcet::BoundOptions& options, const wcet::BoardTiming& timing,
                    const std::optional<core::TickCosts>& stored) {
  BoardCosts result{timing, stored.value_or(core::TickCosts{}), options.image.string(), true};
  if (result.costs.known != core::kTickCostsKnown) {
    wcet::BoundOptions timed = options;
    timed.timing = &timing;
    result.costs = wcet::tick_costs(timed);
    result.embedded = false;
  }
  return result;
}

}  // namespace

BoardCosts costs_of_board(const std::string& name, const std::string& firmware) {
  const emulation::BoardDescription* const board = emulation::find_board(name);
  const wcet::BoardTiming* const timing = wcet::find_timing(name);
  if (board == nullptr || timing == nullptr) {
    throw support::UserError(
        fmt::format("--board: the timing of {} is unknown (name another board, or leave "
                    "the option out)",
                    name));
  }
  const wcet::BoundOptions options = analysis_of(*board, firmware);
  return costs_of(options, *timing, wcet::embedded(options.image));
}

BoardCosts costs_of_image(const std::string& file, const FirmwareImage& image,
                          const std::string& board) {
  wcet::BoundOptions options;
  options.image = file;
  options.sources = {source_folder()};
  options.entries = wcet::tick_entries();
  const std::optional<core::TickCosts> stored = wcet::find_embedded(file);
  const bool has_costs = stored && stored->known == core::kTickCostsKnown;
  if (!board.empty() && (has_costs || !is_board_file(board))) {
    return costs_of(options, timing_of(board), stored);
  }
  const wcet::BoardTiming* const known = board.empty() ? wcet::find_timing(image.board) : nullptr;
  if (known != nullptr) {
    return costs_of(options, *known, stored);
  }
  if (image.clock_hz == 0U || !has_costs) {
    throw support::UserError(fmt::format(
        "{}: the cycles of a tick are unknown (write them into the image with tactree bound "
        "--embed, and state its clock in its record or with --board FILE.json)",
        file));
  }
  wcet::BoardTiming timing;
  timing.board = image.board;
  timing.clock_hz = image.clock_hz;
  timing.is_estimate = false;
  timing.source = "as the image states";
  return costs_of(options, timing, stored);
}

core::DeviceModel slowest_or(const std::string& device) {
  if (!device.empty()) {
    return support::load_device(device).preset.model;
  }
  core::DeviceModel slowest;
  slowest.kind = core::DeviceKind::kDelta;
  return slowest;
}

std::vector<std::string> boards_with_timing() {
  std::vector<std::string> names;
  for (const emulation::BoardDescription& board : emulation::boards()) {
    if (wcet::find_timing(board.name) != nullptr) {
      names.emplace_back(board.name);
    }
  }
  return names;
}

}  // namespace tactree::cli
