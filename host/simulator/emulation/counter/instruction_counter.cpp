// QEMU plugin that counts the instructions that a board executes in each tick, by function.
//   -plugin file=tactree_instruction_counter.so,out=FILE[,skip=TICKS][,code=on]
//
// A tick is the time from leaving tactree_idle() to the return to it, if tactree_tick() was called
// in between. The first TICKS ticks are not counted.
//
// The report:  ticks <count> <max> <total> <checksum> <instructions before the first tick>
//              bucket <n> <ticks with n .. n + 127 instructions>, ascending
//              worst <number of the longest tick; the first counted tick is 0>
//              function <max in a tick> <total> <name>      for each function executed in a tick
//              code <begin> <end>     with code=on: addresses executed in ticks, in hex
//              data <address> <lowest> <highest>  range accessed by the instruction at the address
//              end

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

#include "qemu_plugin_api.hpp"

namespace {

// A number that the emulator increments, in version 2 of its interface in its own memory.
class Count {
 public:
  Count() {
    static Block block;
    if (block.used == kNumbers) {
      block = Block{};
      block.used = 0;
      if (qemu_plugin_scoreboard_new != nullptr) {
        block.score = qemu_plugin_scoreboard_new(kNumbers * sizeof(std::uint64_t));
        block.numbers = static_cast<std::uint64_t*>(qemu_plugin_scoreboard_find(block.score, 0));
      } else {
        block.numbers = new std::uint64_t[kNumbers]();
      }
    }
    place_ = {block.score, block.used * sizeof(std::uint64_t)};
    value_ = block.numbers + block.used;
    ++block.used;
  }
  [[nodiscard]] std::uint64_t value() const { return *value_; }
  /// From now on counts how often the instruction is executed.
  void add_each(qemu_plugin_insn* instruction) const {
    if (place_.score != nullptr) {
      qemu_plugin_register_vcpu_insn_exec_inline_per_vcpu(instruction, QEMU_PLUGIN_INLINE_ADD_U64,
                                                          place_, 1);
    } else {
      qemu_plugin_register_vcpu_insn_exec_inline(instruction, QEMU_PLUGIN_INLINE_ADD_U64, value_,
                                                 1);
    }
  }

 private:
  static constexpr std::size_t kNumbers = 512;  // in a block
  struct Block {
    qemu_plugin_scoreboard* score = nullptr;
    std::uint64_t* numbers = nullptr;
    std::size_t used = kNumbers;
  };
  qemu_plugin_u64 place_{};
  std::uint64_t* value_ = nullptr;
};

struct Function {
  std::string name;
  Count executed;
  std::uint64_t before = 0;  // value of `executed` when the tick began
  std::uint64_t max = 0;
  std::uint64_t total = 0;
};

struct Instruction {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  Count executed;
  std::uint64_t before = 0;      // value of `executed` at the first tick
  std::uint64_t lowest = ~0ULL;  // range of the addresses that it accesses in ticks
  std::uint64_t highest = 0;
};

// FNV-1a.
class Checksum {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      state_ = (state_ ^ static_cast<std::uint32_t>((value >> (8 * byte)) & 0xFFU)) * 16777619U;
    }
  }
  [[nodiscard]] std::uint32_t value() const { return state_; }

 private:
  std::uint32_t state_ = 2166136261U;
};

constexpr std::uint64_t kBucket = 128;  // instructions; equal to emulation::kBucketInstructions

// Needs no locks, because a board with one core runs in one thread.
struct Counter {
  std::deque<Function> functions;  // a deque, because `by_name` has addresses of elements
  std::unordered_map<std::string, Function*> by_name;
  std::deque<Instruction> instructions;
  bool notes_code = false;
  std::string report_file;
  std::uint64_t skip = 0;
  std::uint64_t seen = 0;
  std::uint64_t ticks = 0;
  std::uint64_t max = 0;
  std::uint64_t total = 0;
  std::uint64_t worst = 0;
  std::uint64_t start = 0;
  std::map<std::uint64_t, std::uint64_t> buckets;  // ticks by instructions, rounded down to kBucket
  Checksum checksum;
  bool in_tick = false;

  Function& function(const char* name) {
    const std::string key = name == nullptr || *name == 0 ? "(no name)" : name;
    Function*& entry = by_name[key];
    if (entry == nullptr) {
      functions.emplace_back().name = key;
      entry = &functions.back();
    }
    return *entry;
  }

  void begin_tick() {
    if (in_tick) {
      end_tick();  // the previous tick was late: the board was not idle since
    } else if (seen == 0) {
      for (Instruction& instruction : instructions) {
        instruction.before = instruction.executed.value();
      }
    }
    in_tick = true;
  }

  void idle() {
    if (in_tick) {
      end_tick();
    } else {
      forget();
    }
    in_tick = false;
  }

 private:
  // Discards the instructions executed outside ticks.
  void forget() {
    for (Function& f : functions) {
      start += seen == 0 ? f.executed.value() - f.before : 0U;
      f.before = f.executed.value();
    }
  }

  void end_tick() {
    const bool counts = seen >= skip;
    ++seen;
    std::uint64_t sum = 0;
    for (Function& f : functions) {
      const std::uint64_t own = f.executed.value() - f.before;
      f.before = f.executed.value();
      f.max = counts && own > f.max ? own : f.max;
      f.total += counts ? own : 0U;
      sum += own;
    }
    if (counts) {
      worst = sum > max ? ticks : worst;
      ++ticks;
      max = sum > max ? sum : max;
      total += sum;
      checksum.add(sum);
      ++buckets[sum / kBucket * kBucket];
    }
  }
};

// Never destroyed, because the report is written after the destruction of static objects.
Counter& counter = *new Counter;

void note_data(unsigned, qemu_plugin_meminfo_t, std::uint64_t address, void* data) {
  if (counter.in_tick) {
    auto& instruction = *static_cast<Instruction*>(data);
    instruction.lowest = address < instruction.lowest ? address : instruction.lowest;
    instruction.highest = address > instruction.highest ? address : instruction.highest;
  }
}

void note(qemu_plugin_insn* instruction) {
  const std::uint64_t begin = qemu_plugin_insn_vaddr(instruction);
  counter.instructions.push_back({begin, begin + qemu_plugin_insn_size(instruction), {}});
  counter.instructions.back().executed.add_each(instruction);
  qemu_plugin_register_vcpu_mem_cb(instruction, note_data, QEMU_PLUGIN_CB_NO_REGS,
                                   QEMU_PLUGIN_MEM_RW, &counter.instructions.back());
}

void translated(qemu_plugin_id_t, qemu_plugin_tb* block) {
  const std::size_t count = qemu_plugin_tb_n_insns(block);
  for (std::size_t i = 0; i < count; ++i) {
    qemu_plugin_insn* instruction = qemu_plugin_tb_get_insn(block, i);
    const char* name = qemu_plugin_insn_symbol(instruction);
    const std::string_view symbol = name == nullptr ? "" : name;
    if (symbol == "tactree_idle") {
      qemu_plugin_register_vcpu_insn_exec_cb(
          instruction, [](unsigned, void*) { counter.idle(); }, QEMU_PLUGIN_CB_NO_REGS, nullptr);
      continue;
    }
    Function& function = counter.function(name);
    // The first block of the function to be translated begins at the function's entry.
    static std::uint64_t entry = 0;
    const std::uint64_t address = qemu_plugin_insn_vaddr(instruction);
    if (symbol == "tactree_tick" && (entry == 0 || entry == address)) {
      entry = address;
      qemu_plugin_register_vcpu_insn_exec_cb(
          instruction, [](unsigned, void*) { counter.begin_tick(); }, QEMU_PLUGIN_CB_NO_REGS,
          nullptr);
    }
    function.executed.add_each(instruction);
    if (counter.notes_code) {
      note(instruction);
    }
  }
}

// Adjacent instructions form one range.
void write_code(std::FILE* file) {
  std::map<std::uint64_t, std::uint64_t> executed;
  for (const Instruction& instruction : counter.instructions) {
    if (instruction.executed.value() > instruction.before) {
      executed[instruction.begin] = instruction.end;
    }
  }
  for (auto range = executed.begin(); range != executed.end();) {
    const std::uint64_t begin = range->first;
    std::uint64_t end = begin;
    for (; range != executed.end() && range->first == end; ++range) {
      end = range->second;
    }
    std::fprintf(file, "code %llx %llx\n", static_cast<unsigned long long>(begin),
                 static_cast<unsigned long long>(end));
  }
}

void write_data(std::FILE* file) {
  for (const Instruction& instruction : counter.instructions) {
    if (instruction.lowest <= instruction.highest) {
      std::fprintf(file, "data %llx %llx %llx\n",
                   static_cast<unsigned long long>(instruction.begin),
                   static_cast<unsigned long long>(instruction.lowest),
                   static_cast<unsigned long long>(instruction.highest));
    }
  }
}

void write_report(qemu_plugin_id_t, void*) {
  std::FILE* file = std::fopen(counter.report_file.c_str(), "w");
  if (file == nullptr) {
    return;
  }
  std::fprintf(
      file, "ticks %llu %llu %llu %u %llu\n", static_cast<unsigned long long>(counter.ticks),
      static_cast<unsigned long long>(counter.max), static_cast<unsigned long long>(counter.total),
      counter.checksum.value(), static_cast<unsigned long long>(counter.start));
  std::fprintf(file, "worst %llu\n", static_cast<unsigned long long>(counter.worst));
  for (const auto& [fewest, ticks] : counter.buckets) {
    std::fprintf(file, "bucket %llu %llu\n", static_cast<unsigned long long>(fewest),
                 static_cast<unsigned long long>(ticks));
  }
  for (const Function& f : counter.functions) {
    if (f.total > 0) {
      std::fprintf(file, "function %llu %llu %s\n", static_cast<unsigned long long>(f.max),
                   static_cast<unsigned long long>(f.total), f.name.c_str());
    }
  }
  write_code(file);
  write_data(file);
  std::fprintf(file, "end\n");
  std::fclose(file);
}

}  // namespace

int qemu_plugin_version = 1;

namespace {
// When the emulator has loaded the plugin and before it reads the version.
[[gnu::constructor]] void select_version() {
  qemu_plugin_version = qemu_plugin_scoreboard_new != nullptr ? 2 : 1;
}
}  // namespace

int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t*, int count, char** arguments) {
  for (int i = 0; i < count; ++i) {
    const std::string_view argument = arguments[i];
    if (argument.starts_with("out=")) {
      counter.report_file = argument.substr(4);
    } else if (argument.starts_with("skip=")) {
      counter.skip = std::strtoull(arguments[i] + 5, nullptr, 10);
    } else if (argument == "code=on") {
      counter.notes_code = true;
    } else {
      std::fprintf(stderr, "tactree_instruction_counter: unknown argument %s\n", arguments[i]);
      return 1;
    }
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, write_report, nullptr);
  return 0;
}
