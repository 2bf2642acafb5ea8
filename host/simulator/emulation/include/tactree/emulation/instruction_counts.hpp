#pragma once
// Results of the instruction counter in the emulator.

#include <cstdint>
#include <string>
#include <vector>

namespace tactree::emulation {

struct FunctionCount {
  std::string name;         ///< demangled
  std::uint64_t max = 0;    ///< instructions in one tick
  std::uint64_t total = 0;  ///< in all ticks
};

/// Addresses of code, [begin, end).
struct CodeRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Ticks with `fewest` .. `fewest` + kBucketInstructions - 1 instructions.
struct InstructionBucket {
  std::uint64_t fewest = 0;
  std::uint64_t ticks = 0;
};
inline constexpr std::uint64_t kBucketInstructions = 128;

/// Range of the addresses that an instruction loaded or stored.
struct DataRange {
  std::uint32_t instruction = 0;
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0;
};

/// Numbers of instructions. A tick lasts from its interrupt until the board is idle.
struct InstructionCounts {
  std::uint64_t start = 0;  ///< from reset to the first tick, including the check of the blob
  std::uint64_t ticks = 0;
  std::uint64_t max = 0;
  std::uint64_t worst_tick = 0;  ///< number of the first tick with `max`, from 0
  std::uint64_t total = 0;
  std::uint32_t checksum = 0;              ///< of the counts of all ticks; equal for equal runs
  std::vector<FunctionCount> functions;    ///< in descending order of `total`
  std::vector<InstructionBucket> buckets;  ///< those with ticks, in ascending order
  std::vector<CodeRange> code;             ///< executed in ticks; with note_code only
  std::vector<DataRange> data;             ///< accessed in ticks; with note_code only
  [[nodiscard]] double mean() const {
    return ticks == 0 ? 0.0 : static_cast<double>(total) / static_cast<double>(ticks);
  }
};

/// Reads the counter's report. Throws EmulationError if it is not complete.
[[nodiscard]] InstructionCounts parse_instruction_counts(const std::string& report);

}  // namespace tactree::emulation
