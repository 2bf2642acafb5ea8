#pragma once
// The worst-case bound of a tick: the longest way through the machine code of an image that the
// bounds beside the loops of its source allow. (Implicit path enumeration: Li and Malik,
// "Performance analysis of embedded software using implicit path enumeration", DAC 1995.)
//
// How often each block is executed is a variable; flow in is flow out; a loop's header is executed
// so often as its bound says for each time the loop is entered; the weighted sum is maximised.

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tactree/core/blob_format.hpp"
#include "tactree/core/surface.hpp"
#include "tactree/core/tick_cost.hpp"

namespace tactree::bound {

/// What the names in the bounds stand for, but for constants of the source.
using Parameters = std::map<std::string, std::int64_t>;

/// Those of the models that a board has loaded.
[[nodiscard]] Parameters parameters_of(const core::BlobHeader& header, core::RenderMode mode,
                                       std::uint32_t bodies, core::DeviceKind device);
/// Of a model that has these figures, and else the largest; `delta`: the device is one.
[[nodiscard]] Parameters parameters_of(const core::TickFigures& figures, core::TickKind kind,
                                       std::uint32_t bodies, bool delta);
/// Of full leaves and balls at the greatest depth.
[[nodiscard]] core::TickFigures largest_figures();

/// One way to divide the work of a tick, of all bodies: with so many gathers, so much is left.
struct Division {
  std::uint32_t gathers = 0;
  std::uint32_t passes = 0;
  std::uint32_t fits = 0;      ///< places where it fits: each takes a pass and begins with two
  std::uint32_t searches = 0;  ///< for the nearest candidate, before a fit
};
/// By the number of gathers, from none; for a tick of this pace, core::pace_of().
[[nodiscard]] std::vector<Division> divisions(std::uint32_t pace, std::uint32_t bodies);

/// A function the processor enters by itself, and how often in one tick.
struct EntryPoint {
  std::string function;
  std::uint32_t times = 1;
};

/// Those of a tick: its interrupt, and that of the timer, which begins the tick and may come once
/// more before it ends.
[[nodiscard]] std::vector<EntryPoint> tick_entries();

/// How long the memories of a board make its core wait.
struct BoardTiming {
  const char* board;
  double clock_hz;
  std::uint32_t fetch_wait;   ///< cycles for each line of code, fetched anew in each block that is
                              ///< in no loop which the cache holds
  std::uint32_t line_bytes;   ///< of such a line
  std::uint32_t cache_lines;  ///< of code that stay until this many others were used after them
  bool prefetches;            ///< the next line, while this one is executed
  std::uint32_t ram_wait;     ///< cycles for each word on the stack, and where the source says RAM
  std::uint32_t data_wait;    ///< for each other word, wherever it is
  bool is_estimate;           ///< the core is no Cortex-M4, or its board publishes no figures
  const char* source;
};
/// nullptr: nothing is known about the board.
[[nodiscard]] const BoardTiming* find_timing(const std::string& board);

struct BoundOptions {
  std::filesystem::path image;
  /// The folder that the names of the image's sources are below.
  std::filesystem::path sources;
  std::vector<EntryPoint> entries;
  Parameters parameters;
  /// Of the rate, core::pace_of(): the worst of its divisions is looked for.
  std::uint32_t pace = 0;
  /// Also what the tick takes in cycles; nullptr: instructions only.
  const BoardTiming* timing = nullptr;
};

struct LoopOnPath {
  std::string file;
  std::uint32_t line = 0;
  std::string function;  ///< whose machine code it is in
  std::uint32_t address = 0;
  std::string bound;        ///< as it is written
  std::int64_t passes = 0;  ///< what that comes to, each time the loop is entered
  double total = 0.0;       ///< passes of its header in the worst tick
};

struct FunctionOnPath {
  std::string name;
  double calls = 0.0;         ///< in the worst tick
  double instructions = 0.0;  ///< its own
};

struct BlockOnPath {
  std::uint32_t address = 0;
  std::uint32_t end = 0;
  std::uint32_t instructions = 0;
  double times = 0.0;
};

/// Cycles of a tick of each pace, core::pace_of().
using PaceCycles = std::array<double, core::kPaces>;

struct Bound {
  Parameters parameters;                  ///< those given, and of the worst division
  std::uint64_t instructions = 0;         ///< of one tick, at most
  std::uint64_t cycles = 0;               ///< the same, where the board's timing is known
  PaceCycles pace_cycles{};               ///< and at each pace, whatever that of the parameters is
  std::vector<FunctionOnPath> functions;  ///< the costliest first
  std::vector<LoopOnPath> loops;
  std::vector<std::string>
      unused_facts;                  ///< `at most:` that the compiler left nothing of, file:line
  std::vector<BlockOnPath> endings;  ///< functions that never return: no tick leads there
  std::vector<BlockOnPath> blocks;   ///< all that were analysed, on the path or not
  std::set<std::uint32_t> in_ram;    ///< instructions whose data are said to be in RAM
};

/// Highest rate, Hz, that these leave time for.
[[nodiscard]] double highest_rate(double clock_hz, const PaceCycles& cycles);

/// Throws BoundError on what has no bound: a loop without an annotation, recursion, an indirect
/// call, an unknown instruction; each named with file and line.
[[nodiscard]] Bound worst_case(const BoundOptions& options);

/// The worst case in cycles as a formula in the figures of the model. Of `options`, the parameters
/// do not count. Never less than the cycles of worst_case(), whatever the figures up to
/// largest_figures().
[[nodiscard]] core::TickCosts tick_costs(const BoundOptions& options);

/// Writes them into an image, from where its controller reads them. Its checksum is no longer
/// right: scripts/seal-image.
void embed(const std::filesystem::path& image, const core::TickCosts& costs);
/// As compiled they are not known: zeros.
[[nodiscard]] core::TickCosts embedded(const std::filesystem::path& image);

}  // namespace tactree::bound
