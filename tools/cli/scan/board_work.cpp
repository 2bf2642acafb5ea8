#include "scan/board_work.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "image/board_costs.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

constexpr core::RenderMode kModes[] = {core::RenderMode::kSurface, core::RenderMode::kPaper};

double most_cycles(const std::string& board, float rate_hz, const core::BlobHeader& model,
                   const std::string& firmware) {
  if (wcet::find_timing(board) == nullptr) {
    throw support::UserError(fmt::format("there is no timing table for the board {}", board));
  }
  const BoardCosts costs = costs_of_board(board, firmware);
  core::Configuration configuration;
  configuration.rate_hz = rate_hz;
  configuration.device = slowest_or("");
  double most = 0.0;
  for (const core::RenderMode mode : kModes) {
    configuration.mode = mode;
    most = std::max(most, costs.cycles(model, configuration));
  }
  return most;
}

double most_instructions(const emulation::BoardDescription& board, float rate_hz,
                         const core::BlobHeader& model, const std::string& firmware) {
  wcet::BoundOptions options = analysis_of(board, firmware);
  options.work_tier = core::work_tier_of(rate_hz);
  double most = 0.0;
  for (const core::RenderMode mode : kModes) {
    options.parameters = wcet::parameters_of(model, mode, 1, slowest_or("").kind);
    most = std::max(most, static_cast<double>(wcet::worst_case(options).instructions));
  }
  return most;
}

}  // namespace

viewer::Work work_of_board(const std::string& board, const core::wire::CapabilitiesReply& can,
                           const core::BlobHeader& model, const std::string& firmware) {
  const emulation::BoardDescription* const emulated = emulation::find_board(board);
  viewer::Work work;
  try {
    if (can.cycles_per_tick != 0U) {
      work = {"cycles", static_cast<double>(can.cycles_per_tick), {}, {}};
      work.bound = most_cycles(board, can.rate_hz, model, firmware);
    } else if (emulated != nullptr && emulated->serves) {
      const double instruction_s = 1e-9 * static_cast<double>(1U << emulated->instruction_shift);
      work = {"instructions", 1.0 / (static_cast<double>(can.rate_hz) * instruction_s), {}, {}};
      work.bound = most_instructions(*emulated, can.rate_hz, model, firmware);
    } else {
      work.why = "This board counts neither instructions nor cycles.";
    }
  } catch (const std::runtime_error& error) {
    work.why = fmt::format("No bound is drawn: {}.", error.what());
  }
  return work;
}

}  // namespace tactree::cli
