#include "bound_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "blob_file.hpp"
#include "command.hpp"
#include "output_file.hpp"
#include "tactree/bound/bound.hpp"
#include "tactree/core/scene.hpp"

namespace tactree::cli {
namespace {

// Functions and loops the summary names.
constexpr std::size_t kReported = 12;

struct BoundCommandOptions {
  std::string image;
  std::string blob;
  std::string sources = TACTREE_SOURCES;
  std::string json;
  std::string mode = "surface";
  std::uint32_t bodies = 1;
};

bound::Parameters parameters(const BoundCommandOptions& options) {
  const auto mode =
      options.mode == "paper" ? core::RenderMode::kPaper : core::RenderMode::kSurface;
  if (options.blob.empty()) {
    return bound::largest_parameters(mode, options.bodies);
  }
  const BlobFile blob(options.blob);
  return bound::parameters_of(blob.view().header(), mode, options.bodies);
}

nlohmann::json to_json(const BoundCommandOptions& options, const bound::Parameters& parameters,
                       const bound::Bound& bound) {
  nlohmann::json functions = nlohmann::json::array();
  for (const bound::FunctionOnPath& f : bound.functions) {
    functions.push_back({{"name", f.name}, {"calls", f.calls}, {"instructions", f.instructions}});
  }
  nlohmann::json loops = nlohmann::json::array();
  for (const bound::LoopOnPath& loop : bound.loops) {
    loops.push_back({{"file", loop.file},
                     {"line", loop.line},
                     {"function", loop.function},
                     {"address", loop.address},
                     {"bound", loop.bound},
                     {"passes", loop.passes},
                     {"total", loop.total}});
  }
  return {{"image", options.image},     {"blob", options.blob},   {"parameters", parameters},
          {"instructions", bound.instructions}, {"functions", functions}, {"loops", loops}};
}

void print(const bound::Parameters& parameters, const bound::Bound& bound) {
  fmt::print("instructions       {} in one tick at most\n", bound.instructions);
  for (const auto& [name, value] : parameters) {
    fmt::print("  {:<22} {}\n", name, value);
  }
  for (const std::string& fact : bound.unused_facts) {
    fmt::print("without effect     {}: 'at most' on a line without a call or store\n", fact);
  }
  fmt::print("functions\n");
  for (std::size_t i = 0; i < std::min(kReported, bound.functions.size()); ++i) {
    const bound::FunctionOnPath& f = bound.functions[i];
    fmt::print("  {:8.0f} {:7.0f} x  {}\n", f.instructions, f.calls, f.name);
  }
  fmt::print("loops              passes each time, in the worst tick\n");
  for (const bound::LoopOnPath& loop : bound.loops) {
    fmt::print("  {:6} {:8.0f}  {}:{}: {}\n", loop.passes, loop.total, loop.file, loop.line,
               loop.bound);
  }
}

void bound_tick(const BoundCommandOptions& options) {
  bound::BoundOptions analysis;
  analysis.image = options.image;
  analysis.sources = options.sources;
  analysis.entries = bound::tick_entries();
  analysis.parameters = parameters(options);
  const bound::Bound result = bound::worst_case(analysis);
  print(analysis.parameters, result);
  if (!options.json.empty()) {
    write_file(options.json, to_json(options, analysis.parameters, result).dump(2) + "\n");
  }
}

}  // namespace

void add_bound_command(CLI::App& app, int&) {
  auto options = std::make_shared<BoundCommandOptions>();
  CLI::App* verb = app.add_subcommand(
      "bound", "Proves from a board's image how many instructions a tick takes at most");
  verb->add_option("IMAGE", options->image, "the image: <board>.elf")->required();
  verb->add_option("--blob", options->blob,
                   "the model on the board; without it: every model that a controller accepts");
  verb->add_option("--mode", options->mode, "surface or paper")
      ->check(CLI::IsMember({"surface", "paper"}));
  verb->add_option("--bodies", options->bodies, "models within reach of the probe at a time")
      ->check(CLI::Range(1U, core::kMaxReachableBodies));
  verb->add_option("--sources", options->sources, "the sources that the image was built from");
  verb->add_option("--json", options->json, "write the result to this file");
  verb->callback([options] { bound_tick(*options); });
}

}  // namespace tactree::cli
