#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "commands.hpp"
#include "image/board_costs.hpp"
#include "image/own_board.hpp"
#include "option_checks.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/json_text.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/wcet/bound.hpp"

namespace tactree::cli {
namespace {

// Number of functions in the summary.
constexpr std::size_t kReported = 12;

struct BoundCommandOptions {
  std::string image;
  std::string board;
  std::string blob;
  double rate_hz = 1000.0;
  bool must_keep_rate = false;
  bool embed = false;
  bool quiet = false;
  std::vector<std::string> sources;
  std::vector<std::string> entries;
  std::string json;
  std::string mode = "surface";
  std::uint32_t bodies = 1;
  std::string device;
};

wcet::Parameters parameters(const BoundCommandOptions& options) {
  const auto mode = options.mode == "paper" ? core::RenderMode::kPaper : core::RenderMode::kSurface;
  const core::DeviceKind device = slowest_or(options.device).kind;
  if (!options.blob.empty()) {
    const support::BlobFile blob(options.blob);
    return wcet::parameters_of(blob.view().header(), mode, options.bodies, device);
  }
  const auto kind =
      mode == core::RenderMode::kPaper ? core::TickKind::kPaper : core::TickKind::kMixed;
  return wcet::parameters_of(wcet::largest_model_limits(), kind, options.bodies,
                             device == core::DeviceKind::kDelta);
}

/// Parses NAME or NAME=TIMES.
wcet::EntryPoint entry_of(const std::string& text) {
  const std::size_t sign = text.rfind('=');
  if (sign == std::string::npos || sign + 1 == text.size() ||
      text.find_first_not_of("0123456789", sign + 1) != std::string::npos) {
    return {text, 1};
  }
  const std::uint32_t times = number_of("--entry", text.substr(sign + 1));
  if (times == 0U || times > 1000U) {
    throw CLI::ValidationError("--entry", "'" + text + "': a function is entered 1 .. 1000 times");
  }
  return {text.substr(0, sign), times};
}

/// Image, sources and entry points.
wcet::BoundOptions analysed_image(const BoundCommandOptions& options) {
  wcet::BoundOptions analysis;
  analysis.image = options.image;
  analysis.sources.assign(options.sources.begin(), options.sources.end());
  if (analysis.sources.empty()) {
    analysis.sources.emplace_back(source_folder());
  }
  for (const std::string& entry : options.entries) {
    analysis.entries.push_back(entry_of(entry));
  }
  if (analysis.entries.empty()) {
    analysis.entries = wcet::tick_entries();
  }
  return analysis;
}

nlohmann::json to_json(const BoundCommandOptions& options, const wcet::BoundOptions& analysis,
                       const wcet::Bound& bound, double highest_rate_hz) {
  nlohmann::json functions = nlohmann::json::array();
  for (const wcet::FunctionOnPath& f : bound.functions) {
    functions.push_back({{"name", f.name}, {"calls", f.calls}, {"instructions", f.instructions}});
  }
  nlohmann::json loops = nlohmann::json::array();
  for (const wcet::LoopOnPath& loop : bound.loops) {
    loops.push_back({{"file", loop.file},
                     {"line", loop.line},
                     {"function", loop.function},
                     {"address", loop.address},
                     {"bound", loop.bound},
                     {"passes", loop.passes},
                     {"total", loop.total}});
  }
  nlohmann::json result{{"image", options.image},
                        {"blob", options.blob},
                        {"parameters", bound.parameters},
                        {"instructions", bound.instructions},
                        {"cycles", nullptr},
                        {"functions", functions},
                        {"loops", loops}};
  if (analysis.timing != nullptr) {
    result["cycles"] = bound.cycles;
    result["cycles_are_an_estimate"] = analysis.timing->is_estimate;
    result["rate_max_hz"] = highest_rate_hz;
  }
  return result;
}

void print(const wcet::Bound& bound) {
  fmt::print("instructions       {} in one tick at most\n", bound.instructions);
  for (const auto& [name, value] : bound.parameters) {
    fmt::print("  {:<22} {}\n", name, value);
  }
  for (const std::string& fact : bound.unused_facts) {
    fmt::print("without effect     {}: 'at most:' on a line without a call or store\n", fact);
  }
  fmt::print("functions\n");
  for (std::size_t i = 0; i < std::min(kReported, bound.functions.size()); ++i) {
    const wcet::FunctionOnPath& f = bound.functions[i];
    fmt::print("  {:8.0f} {:7.0f} x  {}\n", f.instructions, f.calls, f.name);
  }
  fmt::print("loops              passes per entry, passes in the worst-case tick\n");
  for (const wcet::LoopOnPath& loop : bound.loops) {
    fmt::print("  {:6} {:8.0f}  {}:{}: {}\n", loop.passes, loop.total, loop.file, loop.line,
               loop.bound);
  }
}

void print_timing(const BoundCommandOptions& options, const wcet::BoardTiming& timing,
                  const wcet::Bound& bound, std::uint32_t work_tier, double highest_rate_hz) {
  fmt::print("cycles             {} at most{}: {:.1f} us of {:.1f} at {:.0f} MHz ({})\n",
             bound.cycles, timing.is_estimate ? ", an estimate" : "",
             1e6 * static_cast<double>(bound.cycles) / timing.clock_hz, 1e6 / options.rate_hz,
             1e-6 * timing.clock_hz, timing.source);
  if (work_tier > core::work_tier_of(static_cast<float>(options.rate_hz))) {
    fmt::print("work               reduced to tier {} of {}, to meet the deadline\n",
               work_tier + 1U, core::kWorkTiers);
  }
  fmt::print("highest rate       {:.0f} Hz, and every lower rate\n", highest_rate_hz);
}

/// Throws UserError if the board cannot keep the rate.
void check_rate(const BoundCommandOptions& options, const wcet::BoardTiming& timing,
                const wcet::Bound& bound, double highest) {
  if (static_cast<double>(bound.cycles) * options.rate_hz > timing.clock_hz) {
    throw support::UserError(fmt::format(
        "--rate: {} runs this model at up to {:.0f} Hz, not at {:.0f} Hz: a tick takes up to {} "
        "cycles, the period has {:.0f} (lower --rate, or build a model with fewer points in a "
        "ball)",
        timing.board, highest, options.rate_hz, bound.cycles, timing.clock_hz / options.rate_hz));
  }
}

/// Bound at the work tier that a board with this timing selects.
wcet::Bound worst_case(wcet::BoundOptions& analysis, double rate_hz) {
  analysis.work_tier = core::work_tier_of(static_cast<float>(rate_hz));
  wcet::Bound bound = wcet::worst_case(analysis);
  if (analysis.timing == nullptr) {
    return bound;
  }
  const std::uint32_t tier =
      wcet::work_tier_in_time(rate_hz, analysis.timing->clock_hz, bound.work_tier_cycles);
  if (tier != analysis.work_tier) {
    analysis.work_tier = tier;
    bound = wcet::worst_case(analysis);
  }
  return bound;
}

void bound_tick(const BoundCommandOptions& options) {
  support::check_outputs({options.json},
                         {options.image, options.blob, options.board, options.device});
  wcet::BoundOptions analysis = analysed_image(options);
  analysis.parameters = parameters(options);
  wcet::BoardTiming timing;
  if (!options.board.empty()) {
    timing = timing_of(options.board);
    analysis.timing = &timing;
  }
  if (options.embed) {
    wcet::embed(options.image, wcet::tick_costs(analysis));
    if (options.quiet) {
      return;
    }
  }
  const wcet::Bound result = worst_case(analysis, options.rate_hz);
  print(result);
  double highest = 0.0;
  if (analysis.timing != nullptr) {
    highest = std::floor(wcet::highest_rate(analysis.timing->clock_hz, result.work_tier_cycles));
    print_timing(options, *analysis.timing, result, analysis.work_tier, highest);
  }
  if (!options.json.empty()) {
    support::write_file(options.json,
                        support::json_text(to_json(options, analysis, result, highest)));
  }
  if (options.must_keep_rate && analysis.timing != nullptr) {
    check_rate(options, *analysis.timing, result, highest);
  }
}

}  // namespace

void add_bound_command(CLI::App& app, int&) {
  auto options = std::make_shared<BoundCommandOptions>();
  CLI::App* verb = app.add_subcommand(
      "bound",
      "Proves the maximum number of instructions and cycles of a tick from a board's image");
  verb->add_option("IMAGE", options->image, "the linked image, with line numbers")->required();
  CLI::Option* board = verb->add_option(
      "--board", options->board,
      "name of the board, or a JSON file with its timing: also prints cycles and the highest rate");
  CLI::Option* embed =
      verb->add_flag(
              "--embed", options->embed,
              "write the cycles into the image, as a formula in the limits of the model: its "
              "controller then refuses models that are too slow (run scripts/seal-image on it)")
          ->needs(board);
  verb->add_flag("--quiet", options->quiet, "with --embed: print nothing")->needs(embed);
  CLI::Option* rate =
      verb->add_option("--rate", options->rate_hz,
                       "ticks per second, Hz; a tick does more work at a low rate. With --board: "
                       "exit code 1 if the board cannot run at this rate")
          ->default_str("1000")
          ->check(within(1.0, 1e6));
  verb->add_option(
      "--blob", options->blob,
      "the model on the board; default: the worst of all models that a controller accepts");
  verb->add_option("--mode", options->mode, "surface or paper")
      ->check(one_of({"surface", "paper"}));
  verb->add_option("--bodies", options->bodies,
                   "number of models within reach of the probe at the same time")
      ->check(within(1U, core::kMaxReachableBodies));
  verb->add_option(
      "--device", options->device,
      "name or file of the device; default: the kind whose tick takes the most cycles");
  verb->add_option(
          "--sources", options->sources,
          "folder of the sources from which the image was built; repeat it for each folder "
          "(default: that of this program)")
      ->type_size(1)
      ->allow_extra_args(false);
  verb->add_option(
          "--entry", options->entries,
          "function that a tick enters: its symbol, or its name in the source; NAME=TIMES "
          "for several times in a tick; repeat it for each function (default: those of the "
          "boards of Tactree)")
      ->type_size(1)
      ->allow_extra_args(false);
  verb->add_option("--json", options->json, "write the result to this file");
  verb->callback([options, rate] {
    options->must_keep_rate = rate->count() > 0;
    bound_tick(*options);
  });
}

}  // namespace tactree::cli
