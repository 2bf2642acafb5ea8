#pragma once
// What the instruction counter in the emulator has found.

#include <cstdint>
#include <string>
#include <vector>

namespace tactree::emulation {

struct FunctionCount {
  std::string name;         ///< demangled
  std::uint64_t max = 0;    ///< instructions in one tick
  std::uint64_t total = 0;  ///< in all ticks
};

/// Addresses of code, from `begin` to one behind the last.
struct CodeRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Ticks of `fewest` instructions to kBucketInstructions more.
struct InstructionBucket {
  std::uint64_t fewest = 0;
  std::uint64_t ticks = 0;
};
inline constexpr std::uint64_t kBucketInstructions = 128;

/// What an instruction loaded or stored: the lowest and the highest address.
struct DataRange {
  std::uint32_t instruction = 0;
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0;
};

/// Instructions from the tick's interrupt until the board idles again.
struct InstructionCounts {
  std::uint64_t start = 0;  ///< from reset to the first tick: checking the blob
  std::uint64_t ticks = 0;
  std::uint64_t max = 0;
  std::uint64_t worst_tick = 0;  ///< the first with that many; counted from 0
  std::uint64_t total = 0;
  std::uint32_t checksum = 0;            ///< over the count of every tick: runs alike have it alike
  std::vector<FunctionCount> functions;  ///< the costliest first
  std::vector<InstructionBucket> buckets;  ///< that are not empty, ascending
  std::vector<CodeRange> code;             ///< executed in ticks, where that was asked for
  std::vector<DataRange> data;             ///< likewise
  [[nodiscard]] double mean() const {
    return ticks == 0 ? 0.0 : static_cast<double>(total) / static_cast<double>(ticks);
  }
};

/// Reads the counter's report. Throws EmulationError on anything else.
[[nodiscard]] InstructionCounts parse_instruction_counts(const std::string& report);

}  // namespace tactree::emulation
