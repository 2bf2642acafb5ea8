#include "tick_analysis.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

// Interrupt entry and return of a Cortex-M4 move 26 words to and from the stack. This includes the
// registers of the FPU, which lazy stacking saves at the first FPU instruction.
constexpr double kEntryCycles = 2.0 * (12.0 + 17.0);

std::vector<std::string> unused_facts(const SourceCode& sources, const WorstPath& path) {
  std::vector<std::string> unused;
  for (const auto& [name, file] : sources.files()) {
    for (const SourceFact& fact : file.facts) {
      if (!path.used_facts.contains(&fact)) {
        unused.push_back(fmt::format("{}:{}", name, fact.line));
      }
    }
  }
  return unused;
}

Bound to_bound(WorstPath path) {
  Bound bound;
  bound.instructions = static_cast<std::uint64_t>(std::floor(path.cost + kRounding));
  for (auto& [entry, function] : path.functions) {
    bound.functions.push_back(std::move(function));
  }
  std::stable_sort(bound.functions.begin(), bound.functions.end(),
                   [](const FunctionOnPath& a, const FunctionOnPath& b) {
                     return a.instructions > b.instructions;
                   });
  for (const auto& [address, block] : path.blocks) {
    bound.blocks.push_back(block);
  }
  bound.loops = std::move(path.loops);
  std::stable_sort(bound.loops.begin(), bound.loops.end(),
                   [](const LoopOnPath& a, const LoopOnPath& b) { return a.address < b.address; });
  return bound;
}

// Annotations limit the sum over the bodies by a number for each of them. With gathers of two
// kinds that number is the mean, rounded up.
core::GatherSlice slice_of_each(const core::SurfaceWork& work, const Division& division) {
  if (division.ahead == 0) {
    return work.slice;
  }
  const std::uint32_t all = division.gathers + division.ahead;
  const auto mean = [&](std::uint32_t on_demand, std::uint32_t ahead) {
    return (division.gathers * on_demand + division.ahead * ahead + all - 1) / all;
  };
  return {mean(work.slice.corners, work.ahead.corners), mean(work.slice.points, work.ahead.points),
          mean(work.slice.candidates, work.ahead.candidates)};
}

}  // namespace

TickAnalysis::TickAnalysis(const BoundOptions& options)
    : image_(options.image), sources_(options.sources) {
  for (const std::string& file : image_.source_files()) {
    (void)sources_.name_of(file);  // reads the file
  }
  std::vector<std::uint32_t> addresses;
  for (const EntryPoint& entry : options.entries) {
    const Function* const function = image_.find(entry.function);
    if (function == nullptr) {
      throw BoundError(
          fmt::format("{}: has no function {} (name the functions that the tick enters with "
                      "--entry; one that the compiler inlines everywhere is none)",
                      image_.name(), entry.function));
    }
    addresses.push_back(function->begin);
    entries_[function->begin] += entry.times;
    times_ += entry.times;
  }
  program_.emplace(image_, sources_, addresses);
  inlined_ = image_.inlined_functions();
}

Bound TickAnalysis::instructions(const Parameters& parameters) {
  const Analysis all = analysis(parameters, {}, nullptr);
  WorstPath path = longest_path(all, entries_, {});
  std::vector<std::string> unused = unused_facts(sources_, path);
  Bound bound = to_bound(std::move(path));
  bound.unused_facts = std::move(unused);
  for (const auto& [entry, function] : program_->functions()) {
    for (const Instruction& instruction : function.flow.instructions) {
      if (is_in_ram(all, instruction)) {
        bound.in_ram.insert(instruction.address);
      }
    }
  }
  for (const std::uint32_t entry : program_->endings()) {
    bound.endings.push_back({entry, image_.functions().at(entry).end, 0, 0.0});
  }
  return bound;
}

std::uint64_t TickAnalysis::cycles(const Parameters& parameters, const BoardTiming& timing) {
  const double cost = longest_path(analysis(parameters, {}, &timing), entries_, {}).cost;
  return static_cast<std::uint64_t>(std::ceil(cost + interrupt_cycles(timing)));
}

CostFormula TickAnalysis::formula(const Parameters& parameters, const OpenParameters& open,
                                  const BoardTiming& timing) {
  CostFormula formula = cost_formula(analysis(parameters, open, &timing), entries_);
  formula.base += interrupt_cycles(timing);
  return formula;
}

Analysis TickAnalysis::analysis(const Parameters& parameters, const OpenParameters& open,
                                const BoardTiming* timing) {
  return {image_, sources_, *program_, parameters, inlined_, open, timing};
}

// The vector is read from flash. The code lines of the handlers may displace those of loops that
// are fetched once per entry.
double TickAnalysis::interrupt_cycles(const BoardTiming& timing) const {
  const bool is_cached =
      std::any_of(program_->functions().begin(), program_->functions().end(),
                  [&](const auto& function) { return function.first >= timing.ram_code_end; });
  return times_ * (kEntryCycles + timing.data_wait +
                   (is_cached ? timing.cache_lines * timing.fetch_wait : 0));
}

Parameters divided(Parameters parameters, std::uint32_t work_tier, const Division& division) {
  const core::SurfaceWork& work = core::kWorkPerTick[work_tier];
  const core::GatherSlice slice = slice_of_each(work, division);
  parameters["gathers"] = division.gathers + division.ahead;
  parameters["ahead"] = work.gathers_ahead() ? 1 : 0;
  parameters["passes"] = division.passes;
  parameters["fits"] = division.fits;
  parameters["fits_of_one"] = division.fits_of_one;
  parameters["slice_corners"] = slice.corners;
  parameters["slice_points"] = slice.points;
  parameters["slice_candidates"] = slice.candidates;
  return parameters;
}

}  // namespace tactree::wcet
