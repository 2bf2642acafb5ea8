#include "block_costs.hpp"

#include <algorithm>

namespace tactree::wcet {
namespace {

// Assumes no prefetch in a line after an access to the flash: later instructions of the line cannot
// make up for this value.
constexpr double kNoPrefetch = -1e9;

bool falls_through(const ControlFlow& flow, const Block& block) {
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  return block.next.size() == 1 && !last.conditional_branch && !last.text.starts_with('b');
}

}  // namespace

CachedLoops BlockCosts::cached_loops(const ControlFlow& flow) const {
  CachedLoops cached;
  cached.loop_of.resize(flow.blocks.size());
  if (analysis_.timing == nullptr) {
    return cached;
  }
  for (std::uint32_t i = 0; i < flow.loops.size(); ++i) {  // outer loops come first
    const NaturalLoop& loop = flow.loops[i];
    if (cached.loop_of[loop.header]) {
      continue;
    }
    CodeLines lines;
    for (const std::uint32_t b : loop.blocks) {
      add_lines(flow, flow.blocks[b], lines);
      add_targets(flow, loop, flow.blocks[b], lines);
      if (flow.blocks[b].calls) {
        add_callee(*flow.blocks[b].calls, lines);
      }
    }
    if (lines.size() <= analysis_.timing->cache_lines) {
      cached.fetch[i] = analysis_.timing->fetch_wait * static_cast<double>(lines.size());
      for (const std::uint32_t b : loop.blocks) {
        cached.loop_of[b] = i;
      }
    }
  }
  return cached;
}

void BlockCosts::add_lines(const ControlFlow& flow, const Block& block, CodeLines& lines) const {
  if (block.count == 0) {
    return;
  }
  if (runs_from_ram(flow.instructions[block.first])) {
    return;
  }
  const std::uint32_t bytes = analysis_.timing->line_bytes;
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  const std::uint32_t end = (last.address + last.bytes - 1) / bytes;
  for (std::uint32_t line = flow.instructions[block.first].address / bytes; line <= end; ++line) {
    lines.insert(line);
  }
}

// Adds the targets of branches out of the loop, because the core may fetch at the target of a
// branch that it does not take.
void BlockCosts::add_targets(const ControlFlow& flow, const NaturalLoop& loop, const Block& block,
                             CodeLines& lines) const {
  for (const std::uint32_t next : block.next) {
    if (!loop.blocks.contains(next) && flow.blocks[next].count != 0 &&
        !runs_from_ram(flow.instructions[flow.blocks[next].first])) {
      lines.insert(flow.instructions[flow.blocks[next].first].address /
                   analysis_.timing->line_bytes);
    }
  }
}

void BlockCosts::add_callee(std::uint32_t entry, CodeLines& lines) const {
  const ControlFlow& flow = analysis_.program.at(entry).flow;
  for (const Block& block : flow.blocks) {
    add_lines(flow, block, lines);
    if (block.calls) {
      add_callee(*block.calls, lines);
    }
  }
}

double BlockCosts::pass(const ControlFlow& flow, const CachedLoops& cached, std::uint32_t b) const {
  const Block& block = flow.blocks[b];
  if (analysis_.timing == nullptr || block.count == 0) {
    return block.count;
  }
  const bool is_cached = cached.loop_of[b].has_value();
  return execution(flow, block) + (is_cached ? 0.0 : fetch(flow, block));
}

double BlockCosts::load(const CachedLoops& cached, std::optional<std::uint32_t> from,
                        std::uint32_t to) {
  const std::optional<std::uint32_t> loop = cached.loop_of[to];
  const bool enters = loop && (!from || cached.loop_of[*from] != loop);
  return enters ? cached.fetch.at(*loop) : 0.0;
}

bool BlockCosts::runs_from_ram(const Instruction& instruction) const {
  return instruction.address < analysis_.timing->ram_code_end;
}

// Words that an instruction loads from the slowest memory. The tick stores nothing there.
std::uint32_t BlockCosts::slow_words(const Instruction& instruction) const {
  const bool is_fast = instruction.store || is_in_ram(analysis_, instruction) ||
                       (instruction.literal && runs_from_ram(instruction));
  return is_fast ? 0U : instruction.other_words;
}

double BlockCosts::execution(const ControlFlow& flow, const Block& block) const {
  const BoardTiming& timing = *analysis_.timing;
  double cycles = 0.0;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Instruction& instruction = flow.instructions[block.first + i];
    const std::uint32_t slow = slow_words(instruction);
    cycles += instruction.cycles + timing.data_wait * slow +
              timing.ram_wait * (instruction.other_words - slow);
  }
  return cycles;
}

// Cycles of a line's prefetch that have passed after one more instruction.
double BlockCosts::prefetched_after(const Instruction& instruction, double cycles) const {
  const bool disturbs = !analysis_.timing->prefetches || slow_words(instruction) > 0;
  return disturbs ? kNoPrefetch : cycles + 1.0;
}

double BlockCosts::fetch(const ControlFlow& flow, const Block& block) const {
  const BoardTiming& timing = *analysis_.timing;
  if (runs_from_ram(flow.instructions[block.first])) {
    return 0.0;
  }
  std::uint32_t line = flow.instructions[block.first].address / timing.line_bytes;
  double wait = timing.fetch_wait;
  double prefetched = 0.0;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Instruction& instruction = flow.instructions[block.first + i];
    const std::uint32_t end = (instruction.address + instruction.bytes - 1) / timing.line_bytes;
    if (end != line) {
      line = end;
      wait += timing.fetch_wait - std::clamp<double>(prefetched, 0.0, timing.fetch_wait);
      prefetched = 0.0;
    }
    prefetched = prefetched_after(instruction, prefetched);
  }
  return wait;
}

// Nothing is saved after a conditional branch that was not taken, because the core may have
// prefetched at its target.
double BlockCosts::saved_by_falling(const ControlFlow& flow, const CachedLoops& cached,
                                    std::uint32_t from, std::uint32_t to) const {
  const Block& block = flow.blocks[from];
  if (analysis_.timing == nullptr || cached.loop_of[to] || flow.blocks[to].count == 0 ||
      block.count == 0 || block.calls || !falls_through(flow, block) ||
      runs_from_ram(flow.instructions[block.first])) {
    return 0.0;
  }
  const BoardTiming& timing = *analysis_.timing;
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  const std::uint32_t begin = flow.instructions[flow.blocks[to].first].address;
  const std::uint32_t line = (last.address + last.bytes - 1) / timing.line_bytes;
  if (begin != last.address + last.bytes) {
    return 0.0;
  }
  return begin / timing.line_bytes == line ? timing.fetch_wait : prefetched_by(flow, block, line);
}

// A branch that is not taken completes in a single cycle (Arm 100166, table 3-1).
double BlockCosts::saved_by_staying(const ControlFlow& flow, std::uint32_t from,
                                    std::uint32_t to) const {
  const Block& block = flow.blocks[from];
  if (analysis_.timing == nullptr || block.count == 0 || flow.blocks[to].count == 0 ||
      block.next.size() < 2) {
    return 0.0;
  }
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  const std::uint32_t begin = flow.instructions[flow.blocks[to].first].address;
  return last.conditional_branch && begin == last.address + last.bytes ? last.cycles - 1.0 : 0.0;
}

// Cycles of the next line's prefetch that the block's last instructions, in `line`, cover.
double BlockCosts::prefetched_by(const ControlFlow& flow, const Block& block,
                                 std::uint32_t line) const {
  const BoardTiming& timing = *analysis_.timing;
  double prefetched = 0.0;
  for (std::uint32_t i = block.first; i < block.first + block.count; ++i) {
    const Instruction& instruction = flow.instructions[i];
    if ((instruction.address + instruction.bytes - 1) / timing.line_bytes == line) {
      prefetched = prefetched_after(instruction, prefetched);
    }
  }
  return std::clamp<double>(prefetched, 0.0, timing.fetch_wait);
}

}  // namespace tactree::wcet
