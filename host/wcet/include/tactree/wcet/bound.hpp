#pragma once
// Worst-case bound of a tick: the maximum number of instructions and cycles of one tick of a linked
// image. docs/BOUND.md describes the method, its assumptions and the annotations.
//
//   BoundOptions options{image, {sources}, tick_entries(), parameters_of(header, mode, 1, device)};
//   options.work_tier = core::work_tier_of(rate_hz);
//   const Bound bound = worst_case(options);
//
// Method: implicit path enumeration (Li and Malik, "Performance analysis of embedded software using
// implicit path enumeration", DAC 1995). The passes of each edge between blocks of machine code are
// the variables of a linear program. The flow into a block equals the flow out of it, annotations
// limit the loops, and the weighted sum is maximised.
//
// Costs: worst_case() solves a few linear programs, about 1 s; tick_costs() some dozens, about 20
// s. All functions may be called from several threads. Errors are BoundError with the text
// "location: cause (hint)".

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tactree/core/contact/surface.hpp"
#include "tactree/core/control/tick_cost.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::wcet {

// ---- input

/// Values of the names in annotations, except constants of the source.
using Parameters = std::map<std::string, std::int64_t>;

/// Parameters of the model with this header on `bodies` bodies.
[[nodiscard]] Parameters parameters_of(const core::BlobHeader& header, core::RenderMode mode,
                                       std::uint32_t bodies, core::DeviceKind device);
/// Parameters of a model with these limits. Parameters that are not in ModelLimits have their
/// maximum values. `delta` is true for a delta robot.
[[nodiscard]] Parameters parameters_of(const core::ModelLimits& limits, core::TickKind kind,
                                       std::uint32_t bodies, bool delta);
/// Limits that no model exceeds: full leaves and balls at the maximum depth.
[[nodiscard]] core::ModelLimits largest_model_limits();

/// A division of a tick's work, summed over all bodies. More gathers on demand leave fewer passes.
struct Division {
  std::uint32_t gathers = 0;      ///< on demand
  std::uint32_t ahead = 0;        ///< further gathers, beside fits
  std::uint32_t passes = 0;       ///< over the candidates
  std::uint32_t fits = 0;         ///< positions with a fit; the first of a body takes two passes
  std::uint32_t fits_of_one = 0;  ///< maximum of `fits` for one body
};
/// All divisions at this work tier (core::work_tier_of()), indexed by their gathers.
[[nodiscard]] std::vector<Division> divisions(std::uint32_t work_tier, std::uint32_t bodies);

/// A function that the processor enters by an interrupt, or that main() calls in its loop.
struct EntryPoint {
  std::string function;     ///< symbol, or name in the source with or without its arguments
  std::uint32_t times = 1;  ///< in one tick
};

/// The interrupt of the tick once, and that of the timer twice: it begins the tick and may occur
/// again before the tick ends.
[[nodiscard]] std::vector<EntryPoint> tick_entries();

/// Wait states of a board's memories.
struct BoardTiming {
  std::string board;
  double clock_hz = 0.0;
  std::uint32_t fetch_wait = 0;    ///< cycles for each code line that is not in the cache
  std::uint32_t line_bytes = 16;   ///< of a code line
  std::uint32_t cache_lines = 0;   ///< of a code cache with LRU replacement; 0: none
  bool prefetches = false;         ///< the next line is fetched while the current one executes
  std::uint32_t ram_wait = 0;      ///< cycles for each word in RAM, except on the stack
  std::uint32_t data_wait = 0;     ///< cycles for each other word
  std::uint32_t ram_code_end = 0;  ///< code below this address is in RAM; its lines have no wait
  bool is_estimate = true;  ///< the core is not a Cortex-M4, or the wait states are not published
  std::string source;
};
/// Returns nullptr if the timing of this board is unknown.
[[nodiscard]] const BoardTiming* find_timing(const std::string& board);

struct BoundOptions {
  /// A linked ELF image with symbols and line numbers.
  std::filesystem::path image;
  /// Folders of the sources from which the image was built, unchanged since: those of Tactree, of
  /// its installed headers, and of the firmware around it.
  std::vector<std::filesystem::path> sources;
  std::vector<EntryPoint> entries;
  Parameters parameters;
  /// core::work_tier_of() of the rate; the bound is the worst of divisions() at this tier.
  std::uint32_t work_tier = 0;
  /// If nullptr, only instructions are bounded, not cycles.
  const BoardTiming* timing = nullptr;
};

// ---- result

struct LoopOnPath {
  std::string file;
  std::uint32_t line = 0;
  std::string function;       ///< that contains the machine code
  std::uint32_t address = 0;  ///< of the loop's header
  std::string bound;          ///< the annotation
  std::int64_t passes = 0;    ///< its value: passes of the body per entry of the loop
  double total = 0.0;         ///< passes of the header in the worst tick
};

struct FunctionOnPath {
  std::string name;
  double calls = 0.0;         ///< in the worst tick
  double instructions = 0.0;  ///< in the worst tick, without callees
};

struct BlockOnPath {
  std::uint32_t address = 0;
  std::uint32_t end = 0;
  std::uint32_t instructions = 0;  ///< of one pass
  double times = 0.0;              ///< in the worst tick
};

/// Cycles of a tick at each work tier.
using WorkTierCycles = std::array<double, core::kWorkTiers>;

struct Bound {
  Parameters parameters;                  ///< of the options and of the worst division
  std::uint64_t instructions = 0;         ///< maximum of one tick
  std::uint64_t cycles = 0;               ///< maximum of one tick; 0 if no timing was given
  WorkTierCycles work_tier_cycles{};      ///< the cycles at every work tier
  std::vector<FunctionOnPath> functions;  ///< in descending order of instructions
  std::vector<LoopOnPath> loops;
  std::vector<std::string> unused_facts;  ///< "file:line" of `at most:` annotations without code
  std::vector<BlockOnPath> endings;       ///< functions that never return; not part of a tick
  std::vector<BlockOnPath> blocks;        ///< all blocks analysed, executed or not
  std::set<std::uint32_t> in_ram;         ///< instructions annotated as accessing RAM only
};

/// Throws BoundError with file and line for a loop without a bound, recursion, an indirect call or
/// jump, an unknown instruction, or an annotation that cannot be applied.
[[nodiscard]] Bound worst_case(const BoundOptions& options);

/// Maximum rate, Hz, at which a tick ends in time with the work tier of the rate or a later one. A
/// tick also ends in time at every lower rate.
[[nodiscard]] double highest_rate(double clock_hz, const WorkTierCycles& cycles);

/// First work tier, beginning with that of the rate, at which a tick ends in time; the last work
/// tier if there is none.
[[nodiscard]] std::uint32_t work_tier_in_time(double rate_hz, double clock_hz,
                                              const WorkTierCycles& cycles);

// ---- admission: the bound as a formula that a board can evaluate

/// Costs in cycles, as a sum over the limits of the model; never less than the cycles of
/// worst_case() up to largest_model_limits(). Ignores the parameters and the work tier of
/// `options`. Throws BoundError as worst_case() does, and if `options` has no timing.
[[nodiscard]] core::TickCosts tick_costs(const BoundOptions& options);

/// Writes the costs into an image. Its checksum is invalid until scripts/seal-image has run.
void embed(const std::filesystem::path& image, const core::TickCosts& costs);
/// The costs in an image. They are all zero in an image that was only linked.
[[nodiscard]] core::TickCosts embedded(const std::filesystem::path& image);
/// As embedded(); nullopt if the image has no room for costs.
[[nodiscard]] std::optional<core::TickCosts> find_embedded(const std::filesystem::path& image);

}  // namespace tactree::wcet
