#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>

#include "linear_program.hpp"
#include "program.hpp"
#include "tactree/bound/bound.hpp"
#include "tactree/bound/bound_error.hpp"
#include "tactree/core/surface.hpp"
#include "tactree/core/tick_cost.hpp"

namespace tactree::bound {
namespace {

/// What a solution by simplex may be too small by.
constexpr double kRounding = 1e-3;

using Entries = std::map<std::uint32_t, double>;  // of functions: how often

/// "tactree::core::Proxy::update(...)" is called Proxy::update in the sources.
bool is_called(const std::string& symbol, const std::string& name) {
  const std::string whole = demangled(symbol);
  const std::string plain = whole.substr(0, whole.find('('));
  return plain == name || plain.ends_with("::" + name);
}

/// A part of a function that the compiler has made a function of its own is not all of it.
bool is_part(const std::string& symbol) {
  return symbol.find(".part.") != std::string::npos || symbol.find(".cold") != std::string::npos;
}

/// What all solutions of one analysis share.
struct Analysis {
  const Image& image;
  const SourceCode& sources;
  Program& program;
  const Parameters& parameters;
  std::set<std::string> inlined;
  /// Names among the parameters whose values a formula leaves open, and their largest values.
  Parameters open;
  const BoardTiming* timing;  ///< what is maximised are cycles; nullptr: instructions
};

/// What the processor does by itself when it enters a function and comes back: registers to the
/// stack and from it, those of the FPU included, whose turn comes with the first instruction that
/// uses them ("lazy stacking").
constexpr double kEntryCycles = 2.0 * (12.0 + 17.0);
constexpr double kEntryWords = 2.0 * 26.0;

/// Lines of code, by their numbers.
using CodeLines = std::set<std::uint32_t>;

void add_lines(const BoardTiming& timing, const ControlFlow& flow, const Block& block,
               CodeLines& lines) {
  if (block.count == 0) {
    return;
  }
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  const std::uint32_t end = (last.address + last.bytes - 1) / timing.line_bytes;
  for (std::uint32_t line = flow.instructions[block.first].address / timing.line_bytes; line <= end;
       ++line) {
    lines.insert(line);
  }
}

/// Does the source say so of the instruction, or of what it is inlined into?
bool is_in_ram(const Analysis& analysis, const Instruction& instruction) {
  if (instruction.literal || instruction.other_words == 0) {
    return false;
  }
  bool in_ram = false;
  for (const Place& place : analysis.program.lines().at(instruction.address)) {
    const SourceFile* const file = analysis.sources.find(place.file);
    if (file != nullptr && file->in_flash.contains(place.line)) {
      return false;
    }
    in_ram = in_ram || (file != nullptr && file->in_ram);
  }
  return in_ram;
}

class Model;

/// The worst case of entry points, or of one call with constant arguments.
struct Solved {
  double cost = 0.0;
  std::map<std::uint32_t, FunctionOnPath> functions;
  std::vector<LoopOnPath> loops;
  std::map<std::uint32_t, BlockOnPath> blocks;
  std::set<const SourceFact*> facts;  // that hold on to code
};

Solved solve(const Analysis& analysis, const Entries& entries, const Parameters& arguments);

/// base + the sum over open parameters of per[name] * value, never less than the worst case.
struct Formula {
  double base = 0.0;
  std::map<std::string, double> per;
};

/// The linear program of one analysis.
class Model {
 public:
  Model(const Analysis& analysis, const Parameters& arguments)
      : analysis_(analysis), arguments_(arguments) {}

  Solved solve(const Entries& entries) {
    write_down(entries);
    if (!open_.empty()) {
      throw BoundError(open_[0].where +
                       ": a model's figure in a function whose calls are analysed "
                       "one by one (use its arguments only)");
    }
    return read(solved_program());
  }

  // Each open limit, what <= (fixed + sum of per * value) * entered, gets a price: what one more
  // pass gains at the parameters given. What it limits is paid at that price, and what it grants is
  // earned at it, whatever the values of the open parameters are. The worst case is then no more
  // than the largest gain of all that has no open parameter, plus, for each of these, its value
  // times the largest sum of the grants per unit of it. (Weak duality of linear programming: true
  // for any prices; good prices make it tight.)
  Formula solve_open(const Entries& entries) {
    write_down(entries);
    const LinearProgram::Solution reference = solved_program();
    std::vector<double> gains = program_.gains();
    std::map<std::string, std::vector<double>> grants;
    for (const OpenLimit& limit : open_) {
      const double price = std::max(reference.price[limit.row], 0.0);
      for (const auto& [variable, coefficient] : limit.what) {
        gains[static_cast<std::size_t>(variable)] -= price * coefficient;
      }
      for (const auto& [variable, coefficient] : limit.entered) {
        gains[static_cast<std::size_t>(variable)] += price * limit.fixed * coefficient;
        for (const auto& [name, per] : limit.per) {
          auto& grant = grants[name];
          grant.resize(gains.size());
          grant[static_cast<std::size_t>(variable)] += price * per * coefficient;
        }
      }
      widen(limit);
    }
    Formula formula;
    formula.base = largest(gains);
    for (auto& [name, grant] : grants) {
      formula.per[name] = largest(std::move(grant));
    }
    return formula;
  }

 private:
  void write_down(const Entries& entries) {
    add_functions(entries);
    connect_calls(entries);
    limit_loops();
    limit_totals();
  }

  [[nodiscard]] LinearProgram::Solution solved_program() const {
    LinearProgram::Solution solution = program_.solve();
    if (!solution.bounded) {
      throw BoundError(analysis_.image.name() +
                       ": the bounds beside the loops contradict each other (correct them)");
    }
    return solution;
  }

  double largest(std::vector<double> gains) {
    program_.set_gains(std::move(gains));
    return solved_program().gain;
  }

  /// A limit that names open parameters.
  struct OpenLimit {
    std::string where;
    std::size_t row = 0;
    Terms what;
    Terms entered;
    double fixed = 0.0;
    std::map<std::string, double> per;
  };

  /// In place of the values given: the largest, so that nothing is without a limit.
  void widen(const OpenLimit& limit) {
    double most = limit.fixed;
    for (const auto& [name, per] : limit.per) {
      most += per * static_cast<double>(analysis_.open.at(name));
    }
    Terms terms = limit.what;
    add(terms, limit.entered, -most);
    program_.replace(limit.row, terms);
  }

  /// what <= limit * entered.
  void limit_to(const Terms& what, const Expression& limit, const std::string& file,
                const Terms& entered) {
    Terms terms = what;
    add(terms, entered, -static_cast<double>(value_of(limit, file)));
    OpenLimit open{file, program_.at_most(terms, 0.0), what, entered, 0.0, {}};
    open.fixed = static_cast<double>(value_with(limit, file, {}));
    for (const auto& [name, largest] : analysis_.open) {
      if (limit.mentions(name)) {
        open.per[name] = static_cast<double>(value_with(limit, file, {{name, 1}})) - open.fixed;
      }
    }
    if (!open.per.empty()) {
      check_linear(open, limit, file);
      open_.push_back(std::move(open));
    }
  }

  void check_linear(const OpenLimit& open, const Expression& limit, const std::string& file) const {
    double sum = open.fixed;
    for (const auto& [name, per] : open.per) {
      sum += per * static_cast<double>(analysis_.open.at(name));
    }
    if (sum != static_cast<double>(value_with(limit, file, analysis_.open))) {
      throw BoundError(
          fmt::format("{}: '{}' is no sum of multiples of the model's figures (write it "
                      "as one)",
                      file, limit.text()));
    }
  }

  /// With these values of the open parameters; those that are not given are 0.
  [[nodiscard]] std::int64_t value_with(const Expression& expression, const std::string& file,
                                        const Parameters& values) const {
    return std::max<std::int64_t>(
        0, expression.value([&](const std::string& name) -> std::optional<std::int64_t> {
          if (analysis_.open.contains(name)) {
            return values.contains(name) ? values.at(name) : 0;
          }
          return named(name, file);
        }));
  }
  struct FunctionVariables {
    int entry = 0;
    std::map<Edge, int> edges;
    std::vector<std::optional<std::uint32_t>> kept_by;  ///< of each block: the loop below
    std::map<std::uint32_t, double> fetch;  ///< of loops that the cache holds: cycles, once
  };

  [[nodiscard]] const AnalysedFunction& function(std::uint32_t entry) const {
    return analysis_.program.at(entry);
  }

  // ---- the flow

  /// The functions below the entry points; those with a cost of their own for each call are not.
  void add_functions(const Entries& entries) {
    std::vector<std::uint32_t> open;
    for (const auto& [entry, times] : entries) {
      open.push_back(entry);
    }
    while (!open.empty()) {
      const std::uint32_t entry = open.back();
      open.pop_back();
      if (variables_.contains(entry)) {
        continue;
      }
      add_function(entry);
      for (const Block& block : function(entry).flow.blocks) {
        if (shares_callee(block)) {
          open.push_back(*block.calls);
        }
      }
    }
  }

  [[nodiscard]] bool calls_one_that_returns(const Block& block) const {
    return block.calls && analysis_.program.returns(*block.calls);
  }
  [[nodiscard]] bool shares_callee(const Block& block) const {
    return calls_one_that_returns(block) && function(*block.calls).arguments.empty();
  }

  void add_function(std::uint32_t entry) {
    const ControlFlow& flow = function(entry).flow;
    FunctionVariables& own = variables_[entry];
    keep_loops(flow, own);
    own.entry = program_.add_variable(gain_of(entry, 0) + fetch_on_entry(own, std::nullopt, 0));
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      for (const std::uint32_t next : flow.blocks[b].next) {
        own.edges[{b, next}] =
            program_.add_variable(gain_of(entry, next) + fetch_on_entry(own, b, next) -
                                  saved_by_falling(own, flow, b, next));
      }
    }
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      conserve(entry, b);
    }
  }

  /// Instructions of one pass of a block, those of a call with constant arguments included.
  double gain_of(std::uint32_t entry, std::uint32_t b) {
    const Block& block = function(entry).flow.blocks[b];
    double gain = cost_of(entry, b);
    if (calls_one_that_returns(block) && !shares_callee(block)) {
      gain += call_with_arguments(entry, b).cost;
    }
    return gain;
  }

  [[nodiscard]] double cost_of(std::uint32_t entry, std::uint32_t b) const {
    const ControlFlow& flow = function(entry).flow;
    const Block& block = flow.blocks[b];
    if (analysis_.timing == nullptr || block.count == 0) {
      return block.count;
    }
    const bool is_kept = variables_.at(entry).kept_by[b].has_value();
    return cycles_of(flow, block) + (is_kept ? 0.0 : fetch_of(flow, block));
  }

  /// Words that an instruction loads from the slowest memory. Nothing is stored there.
  [[nodiscard]] std::uint32_t slow_words(const Instruction& instruction) const {
    const bool is_fast = instruction.store || is_in_ram(analysis_, instruction);
    return is_fast ? 0U : instruction.other_words;
  }

  /// Of one pass of a block, but for its fetch.
  [[nodiscard]] double cycles_of(const ControlFlow& flow, const Block& block) const {
    const BoardTiming& timing = *analysis_.timing;
    double cycles = 0.0;
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const Instruction& instruction = flow.instructions[block.first + i];
      const std::uint32_t slow = slow_words(instruction);
      cycles += instruction.cycles + timing.data_wait * slow +
                timing.ram_wait * (instruction.stack_words + instruction.other_words - slow);
    }
    return cycles;
  }

  // The next line is fetched while the instructions of this one are executed, unless one of them
  // needs the flash itself: how many cycles of that fetch are over after one more instruction.
  [[nodiscard]] double hidden_after(const Instruction& instruction, double hidden) const {
    const bool disturbs = !analysis_.timing->prefetches || slow_words(instruction) > 0;
    return disturbs ? -1e9 : hidden + 1.0;
  }

  /// Cycles that the lines of a block which was jumped to are waited for.
  [[nodiscard]] double fetch_of(const ControlFlow& flow, const Block& block) const {
    const BoardTiming& timing = *analysis_.timing;
    std::uint32_t line = flow.instructions[block.first].address / timing.line_bytes;
    double wait = timing.fetch_wait;
    double hidden = 0.0;
    for (std::uint32_t i = 0; i < block.count; ++i) {
      const Instruction& instruction = flow.instructions[block.first + i];
      const std::uint32_t end = (instruction.address + instruction.bytes - 1) / timing.line_bytes;
      if (end != line) {
        line = end;
        wait += timing.fetch_wait - std::clamp<double>(hidden, 0.0, timing.fetch_wait);
        hidden = 0.0;
      }
      hidden = hidden_after(instruction, hidden);
    }
    return wait;
  }

  // Into a block that follows without a jump: its first line is there already, or has been fetched
  // ahead. After a jump that was not taken nothing is counted on: the core may have gone to fetch
  // where that leads.
  [[nodiscard]] double saved_by_falling(const FunctionVariables& own, const ControlFlow& flow,
                                        std::uint32_t from, std::uint32_t to) const {
    if (analysis_.timing == nullptr || own.kept_by[to] || flow.blocks[to].count == 0 ||
        flow.blocks[from].count == 0 || flow.blocks[from].calls || !falls_through(flow, from)) {
      return 0.0;
    }
    const BoardTiming& timing = *analysis_.timing;
    const Block& block = flow.blocks[from];
    const Instruction& last = flow.instructions[block.first + block.count - 1];
    const std::uint32_t begin = flow.instructions[flow.blocks[to].first].address;
    const std::uint32_t line = (last.address + last.bytes - 1) / timing.line_bytes;
    if (begin != last.address + last.bytes) {
      return 0.0;
    }
    return begin / timing.line_bytes == line ? timing.fetch_wait : hidden_by(flow, block, line);
  }

  static bool falls_through(const ControlFlow& flow, std::uint32_t b) {
    const Block& block = flow.blocks[b];
    const Instruction& last = flow.instructions[block.first + block.count - 1];
    return block.next.size() == 1 && !last.conditional_branch && !last.text.starts_with('b');
  }

  // What the last instructions of a block, in this line, hide of fetching the next.
  [[nodiscard]] double hidden_by(const ControlFlow& flow, const Block& block,
                                 std::uint32_t line) const {
    const BoardTiming& timing = *analysis_.timing;
    double hidden = 0.0;
    for (std::uint32_t i = block.first; i < block.first + block.count; ++i) {
      const Instruction& instruction = flow.instructions[i];
      if ((instruction.address + instruction.bytes - 1) / timing.line_bytes == line) {
        hidden = hidden_after(instruction, hidden);
      }
    }
    return std::clamp<double>(hidden, 0.0, timing.fetch_wait);
  }

  // Code that is used again and again stays where the lines used last do, when the loop and all
  // that it calls have room there: each line is fetched once, each time the loop is entered.
  void keep_loops(const ControlFlow& flow, FunctionVariables& own) const {
    own.kept_by.resize(flow.blocks.size());
    if (analysis_.timing == nullptr) {
      return;
    }
    for (std::uint32_t i = 0; i < flow.loops.size(); ++i) {  // outer loops come first
      const Loop& loop = flow.loops[i];
      if (own.kept_by[loop.header]) {
        continue;
      }
      CodeLines lines;
      for (const std::uint32_t b : loop.blocks) {
        add_lines(*analysis_.timing, flow, flow.blocks[b], lines);
        if (flow.blocks[b].calls) {
          add_callee(*flow.blocks[b].calls, lines);
        }
      }
      if (lines.size() <= analysis_.timing->cache_lines) {
        own.fetch[i] = analysis_.timing->fetch_wait * static_cast<double>(lines.size());
        for (const std::uint32_t b : loop.blocks) {
          own.kept_by[b] = i;
        }
      }
    }
  }

  void add_callee(std::uint32_t entry, CodeLines& lines) const {
    const ControlFlow& flow = function(entry).flow;
    for (const Block& block : flow.blocks) {
      add_lines(*analysis_.timing, flow, block, lines);
      if (block.calls) {
        add_callee(*block.calls, lines);
      }
    }
  }

  static double fetch_on_entry(const FunctionVariables& own, std::optional<std::uint32_t> from,
                               std::uint32_t to) {
    const std::optional<std::uint32_t> loop = own.kept_by[to];
    const bool enters = loop && (!from || own.kept_by[*from] != loop);
    return enters ? own.fetch.at(*loop) : 0.0;
  }

  /// A constant; or what this function itself was called with; or what the source says.
  [[nodiscard]] std::optional<std::int64_t> argument(std::uint32_t entry, std::uint32_t b,
                                                     int number, const std::string& wanted) const {
    const Argument given = function(entry).flow.argument(b, number);
    for (const auto& [name, own] : function(entry).arguments) {
      if (given.passed_on == own && arguments_.contains(name)) {
        return arguments_.at(name);
      }
    }
    return given.constant ? std::optional<std::int64_t>(*given.constant)
                          : said_argument(function(entry).flow, b, wanted);
  }

  [[nodiscard]] std::optional<std::int64_t> said_argument(const ControlFlow& flow, std::uint32_t b,
                                                          const std::string& name) const {
    const Block& block = flow.blocks[b];
    const std::uint32_t last = block.first + std::max(block.count, 1U) - 1;
    std::optional<std::int64_t>
        least;  // where the calls inlined around it say more, that is true too
    for (const Place& place : analysis_.program.lines().at(flow.instructions[last].address)) {
      const SourceFile* const file = analysis_.sources.find(place.file);
      if (file == nullptr) {
        continue;
      }
      for (const SourceArgument& argument : file->arguments) {
        if (argument.line == place.line && argument.name == name) {
          const std::int64_t value = value_of(argument.at_most, argument.file);
          least = std::min(least.value_or(value), value);
        }
      }
    }
    return least;
  }

  /// Each call is analysed by itself, for the values its arguments have there.
  const Solved& call_with_arguments(std::uint32_t entry, std::uint32_t b) {
    const auto known = calls_.find({entry, b});
    if (known != calls_.end()) {
      return known->second;
    }
    const ControlFlow& flow = function(entry).flow;
    const std::uint32_t callee = *flow.blocks[b].calls;
    Parameters arguments;
    for (const auto& [name, number] : function(callee).arguments) {
      const auto value = argument(entry, b, number, name);
      if (!value) {
        const Block& block = flow.blocks[b];
        const std::uint32_t last = block.first + (block.count == 0 ? 0 : block.count - 1);
        throw BoundError(fmt::format(
            "{}: calls {} with an argument '{}' that is no constant (give it one, or say "
            "`with: {} <= ...` beside the call)",
            describe_place(analysis_.image, flow.instructions[last].address),
            demangled(function(callee).flow.function.name), name, name));
      }
      arguments[name] = *value;
    }
    return calls_[{entry, b}] = bound::solve(analysis_, {{callee, 1.0}}, arguments);
  }

  /// How often a block is passed.
  [[nodiscard]] Terms passes(std::uint32_t entry, std::uint32_t b) const {
    const FunctionVariables& own = variables_.at(entry);
    Terms terms;
    for (const auto& [edge, variable] : own.edges) {
      if (edge.second == b) {
        terms[variable] += 1.0;
      }
    }
    if (b == 0) {
      terms[own.entry] += 1.0;
    }
    return terms;
  }

  // What comes in goes out. Where a function ends it is gone; where one is called that never
  // returns, nothing comes in: such a way is no tick.
  void conserve(std::uint32_t entry, std::uint32_t b) {
    const Block& block = function(entry).flow.blocks[b];
    Terms terms = passes(entry, b);
    if (block.returns) {
      terms[program_.add_variable(0.0)] -= 1.0;
    }
    for (const std::uint32_t next : block.next) {
      terms[variables_.at(entry).edges.at({b, next})] -= 1.0;
    }
    program_.equal(terms, 0.0);
  }

  void connect_calls(const Entries& entries) {
    std::map<std::uint32_t, Terms> calls;
    for (const auto& [entry, own] : variables_) {
      calls[entry][own.entry] += 1.0;
      const ControlFlow& flow = function(entry).flow;
      for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
        if (shares_callee(flow.blocks[b])) {
          subtract(calls[*flow.blocks[b].calls], passes(entry, b));
        }
      }
    }
    for (const auto& [entry, terms] : calls) {
      const auto times = entries.find(entry);
      program_.equal(terms, times == entries.end() ? 0.0 : times->second);
    }
  }

  // ---- what the sources say

  [[nodiscard]] std::int64_t value_of(const Expression& expression, const std::string& file) const {
    const std::int64_t value =
        expression.value([&](const std::string& name) { return named(name, file); });
    return std::max<std::int64_t>(value, 0);
  }

  [[nodiscard]] std::optional<std::int64_t> named(const std::string& name,
                                                  const std::string& file) const {
    for (const Parameters* names : {&arguments_, &analysis_.parameters}) {
      const auto found = names->find(name);
      if (found != names->end()) {
        return found->second;
      }
    }
    return analysis_.sources.constant(file, name);
  }

  static void add(Terms& to, const Terms& terms, double factor = 1.0) {
    for (const auto& [variable, coefficient] : terms) {
      to[variable] += factor * coefficient;
    }
  }
  static void subtract(Terms& from, const Terms& terms) { add(from, terms, -1.0); }

  [[nodiscard]] Terms edges(std::uint32_t entry, const std::vector<Edge>& wanted) const {
    Terms terms;
    for (const Edge& edge : wanted) {
      terms[variables_.at(entry).edges.at(edge)] += 1.0;
    }
    return terms;
  }

  /// How often a loop is entered; with its function when its header is the function's entry.
  [[nodiscard]] Terms entered(std::uint32_t entry, const Loop& loop) const {
    Terms terms = edges(entry, loop.entries);
    if (loop.blocks.contains(0)) {
      terms[variables_.at(entry).entry] += 1.0;
    }
    return terms;
  }

  /// Passes of a loop's body. Where that is not clear, of its back edges: the condition may be
  /// evaluated once more than the body is passed.
  [[nodiscard]] Terms bodies(std::uint32_t entry, std::uint32_t number) const {
    const AnalysedFunction& own = function(entry);
    const Loop& loop = own.flow.loops[number];
    switch (own.bounds[number].shape) {
      case LoopShape::kAtEnd:
        return passes(entry, loop.header);
      case LoopShape::kAtStart: {
        std::vector<Edge> inwards;
        for (const std::uint32_t next : own.flow.blocks[loop.header].next) {
          if (loop.blocks.contains(next)) {
            inwards.emplace_back(loop.header, next);
          }
        }
        return edges(entry, inwards);
      }
      default: {
        Terms terms = edges(entry, loop.back);
        if (loop.irregular) {  // it may come to its header before the first pass is done
          subtract(terms, entered(entry, loop));
        }
        if (own.bounds[number].source->tests_last) {  // once around less than passes
          add(terms, entered(entry, loop));
        }
        return terms;
      }
    }
  }

  void limit_loops() {
    for (const auto& [entry, own] : variables_) {
      const AnalysedFunction& f = function(entry);
      for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
        if (f.bounds[i].counts_with == i) {
          limit_loop(entry, i);
        }
      }
    }
  }

  void limit_loop(std::uint32_t entry, std::uint32_t number) {
    const AnalysedFunction& f = function(entry);
    Terms terms;
    for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
      if (f.bounds[i].counts_with == number) {
        add(terms, bodies(entry, i));
      }
    }
    const SourceLoop& source = *f.bounds[number].source;
    limit_to(terms, *source.bound, source.file, entered(entry, f.flow.loops[number]));
  }

  /// sum of `what` <= so often for each call of the function that `total` names.
  void limit_total(const Terms& what, const Total& total, const std::string& file,
                   const std::string& where) {
    Terms calls;
    bool found = false;
    for (const auto& [entry, own] : variables_) {
      const std::string& symbol = function(entry).flow.function.name;
      if (is_called(symbol, total.function)) {
        if (is_part(symbol)) {
          throw BoundError(fmt::format("{}: the compiler has divided {} (mark it gnu::noinline)",
                                       where, total.function));
        }
        calls[own.entry] += 1.0;
        found = true;
      }
    }
    const bool inlined =
        std::any_of(analysis_.inlined.begin(), analysis_.inlined.end(),
                    [&](const std::string& symbol) { return is_called(symbol, total.function); });
    if (!found || inlined) {
      throw BoundError(
          fmt::format("{}: {} is no function of its own in the image (mark it "
                      "gnu::noinline, or correct the name)",
                      where, total.function));
    }
    limit_to(what, total.at_most, file, calls);
  }

  /// What is counted together, and what it comes to.
  struct Group {
    const Total* first = nullptr;
    std::string file;
    std::string where;
    Terms terms;
  };
  using Groups = std::map<std::pair<std::string, std::string>, Group>;  // by function and name

  void limit_totals() {
    Groups groups;
    limit_loop_totals(groups);
    for (const auto& [name, file] : analysis_.sources.files()) {
      for (const SourceFact& fact : file.facts) {
        limit_fact(fact, groups);
      }
    }
    for (const auto& [name, group] : groups) {
      limit_total(group.terms, *group.first, group.file, group.where);
    }
  }

  void limit_loop_totals(Groups& groups) {
    std::map<const SourceLoop*, Terms> passes;
    for (const auto& [entry, own] : variables_) {
      const AnalysedFunction& f = function(entry);
      for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
        add(passes[f.bounds[i].source], bodies(entry, i));
      }
    }
    for (const auto& [loop, terms] : passes) {
      for (const Total& total : loop->totals) {
        limit_alone_or_together(terms, total, loop->file, loop->line, groups);
      }
    }
  }

  void limit_alone_or_together(const Terms& terms, const Total& total, const std::string& file,
                               std::uint32_t line, Groups& groups) {
    const std::string where = fmt::format("{}:{}", file, line);
    if (total.together.empty()) {
      limit_total(terms, total, file, where);
      return;
    }
    Group& group = groups[{total.function, total.together}];
    if (group.first != nullptr && group.first->at_most.text() != total.at_most.text()) {
      throw BoundError(
          fmt::format("{}: '{}', but '{}' in {}, with which it is counted (make them equal)", where,
                      total.at_most.text(), group.first->at_most.text(), group.where));
    }
    group.first = &total;
    group.file = file;
    group.where = where;
    add(group.terms, terms, total.weight);
  }

  // A statement's calls and stores are executed no more often than it is, wherever the compiler has
  // put its other instructions.
  void limit_fact(const SourceFact& fact, Groups& groups) {
    std::map<std::uint32_t, Terms> calls;  // by callee: one statement may call several
    Terms stores;
    for (const auto& [entry, own] : variables_) {
      const ControlFlow& flow = function(entry).flow;
      for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
        const Block& block = flow.blocks[b];
        if (block.calls && is_of(flow, block.first + std::max(block.count, 1U) - 1, fact)) {
          add(calls[*block.calls], passes(entry, b));
        }
        if (has_store(flow, block, fact)) {
          add(stores, passes(entry, b));
        }
      }
    }
    if (!calls.empty() || !stores.empty()) {
      held_.insert(&fact);
    }
    if (calls.empty() && !stores.empty()) {
      calls[0] = stores;
    }
    for (const auto& [callee, terms] : calls) {
      limit_alone_or_together(terms, fact.total, fact.file, fact.line, groups);
    }
  }

  [[nodiscard]] bool is_of(const ControlFlow& flow, std::uint32_t index,
                           const SourceFact& fact) const {
    const auto& places = analysis_.program.lines().at(flow.instructions[index].address);
    return std::find(places.begin(), places.end(), Place{fact.file, fact.line}) != places.end();
  }

  [[nodiscard]] bool has_store(const ControlFlow& flow, const Block& block,
                               const SourceFact& fact) const {
    for (std::uint32_t i = 0; i < block.count; ++i) {
      if (flow.instructions[block.first + i].store && is_of(flow, block.first + i, fact)) {
        return true;
      }
    }
    return false;
  }

  // ---- the answer

  static double sum(const Terms& terms, const LinearProgram::Solution& solution) {
    double result = 0.0;
    for (const auto& [variable, coefficient] : terms) {
      result += coefficient * solution.x[static_cast<std::size_t>(variable)];
    }
    return result;
  }

  Solved read(const LinearProgram::Solution& solution) {
    Solved solved;
    solved.facts = held_;
    solved.cost = solution.gain;
    for (const auto& [entry, own] : variables_) {
      const AnalysedFunction& f = function(entry);
      FunctionOnPath& on_path = solved.functions[entry];
      on_path.name = demangled(f.flow.function.name);
      on_path.calls += solution.x[static_cast<std::size_t>(own.entry)];
      for (std::uint32_t b = 0; b < f.flow.blocks.size(); ++b) {
        const double times = sum(passes(entry, b), solution);
        on_path.instructions += times * f.flow.blocks[b].count;
        note_block(f.flow, b, times, solved);
        if (calls_.contains({entry, b})) {
          include(calls_.at({entry, b}), times, solved);
        }
      }
      for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
        note_loop(entry, i, solution, solved);
      }
    }
    return solved;
  }

  static void note_block(const ControlFlow& flow, std::uint32_t b, double times, Solved& solved) {
    const Block& block = flow.blocks[b];
    if (block.count > 0) {
      BlockOnPath& on_path = solved.blocks[flow.instructions[block.first].address];
      on_path.address = flow.instructions[block.first].address;
      const Instruction& last = flow.instructions[block.first + block.count - 1];
      on_path.end = last.address + last.bytes;
      on_path.instructions = block.count;
      on_path.times += times;
    }
  }

  void note_loop(std::uint32_t entry, std::uint32_t number, const LinearProgram::Solution& solution,
                 Solved& solved) const {
    const AnalysedFunction& f = function(entry);
    const Loop& loop = f.flow.loops[number];
    const SourceLoop& source = *f.bounds[number].source;
    solved.loops.push_back({source.file, source.line, demangled(f.flow.function.name),
                            f.flow.instructions[f.flow.blocks[loop.header].first].address,
                            source.bound->text(), value_of(*source.bound, source.file),
                            sum(passes(entry, loop.header), solution)});
  }

  static void include(const Solved& call, double times, Solved& solved) {
    for (const auto& [entry, f] : call.functions) {
      FunctionOnPath& on_path = solved.functions[entry];
      on_path.name = f.name;
      on_path.calls += times * f.calls;
      on_path.instructions += times * f.instructions;
    }
    for (const auto& [address, block] : call.blocks) {
      BlockOnPath& on_path = solved.blocks[address];
      on_path.address = address;
      on_path.end = block.end;
      on_path.instructions = block.instructions;
      on_path.times += times * block.times;
    }
    for (LoopOnPath loop : call.loops) {
      loop.total *= times;
      solved.loops.push_back(std::move(loop));
    }
  }

  const Analysis& analysis_;
  const Parameters& arguments_;
  LinearProgram program_;
  std::set<const SourceFact*> held_;
  std::vector<OpenLimit> open_;
  std::map<std::uint32_t, FunctionVariables> variables_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Solved> calls_;
};

Solved solve(const Analysis& analysis, const Entries& entries, const Parameters& arguments) {
  return Model(analysis, arguments).solve(entries);
}

Bound to_bound(const SourceCode& sources, Solved solved) {
  Bound bound;
  for (const auto& [name, file] : sources.files()) {
    for (const SourceFact& fact : file.facts) {
      if (!solved.facts.contains(&fact)) {
        bound.unused_facts.push_back(fmt::format("{}:{}", name, fact.line));
      }
    }
  }
  bound.instructions = static_cast<std::uint64_t>(std::floor(solved.cost + kRounding));
  for (auto& [entry, function] : solved.functions) {
    bound.functions.push_back(std::move(function));
  }
  std::stable_sort(bound.functions.begin(), bound.functions.end(),
                   [](const FunctionOnPath& a, const FunctionOnPath& b) {
                     return a.instructions > b.instructions;
                   });
  for (auto& [address, block] : solved.blocks) {
    bound.blocks.push_back(block);
  }
  bound.loops = std::move(solved.loops);
  std::stable_sort(bound.loops.begin(), bound.loops.end(),
                   [](const LoopOnPath& a, const LoopOnPath& b) { return a.address < b.address; });
  return bound;
}

}  // namespace

std::vector<EntryPoint> tick_entries() { return {{"tactree_tick", 1}, {"tactree_deadline", 2}}; }

namespace {

/// An image with its sources and entry points, ready to be analysed with any parameters.
class Task {
 public:
  explicit Task(const BoundOptions& options) : image_(options.image), sources_(options.sources) {
    for (const std::string& file : image_.source_files()) {
      (void)sources_.name_of(file);
    }
    std::vector<std::uint32_t> addresses;
    for (const EntryPoint& entry : options.entries) {
      const Function* const function = image_.find(entry.function);
      if (function == nullptr) {
        throw BoundError(fmt::format("{}: has no function {} (give an image of ours)",
                                     image_.name(), entry.function));
      }
      addresses.push_back(function->begin);
      entries_[function->begin] += entry.times;
      times_ += entry.times;
    }
    program_.emplace(image_, sources_, addresses);
    inlined_ = image_.inlined_functions();
  }

  [[nodiscard]] Bound instructions(const Parameters& parameters) {
    const Analysis all = analysis(parameters, {}, nullptr);
    Bound bound = to_bound(sources_, solve(all, entries_, {}));
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

  [[nodiscard]] std::uint64_t cycles(const Parameters& parameters, const BoardTiming& timing) {
    const double cost = solve(analysis(parameters, {}, &timing), entries_, {}).cost;
    return static_cast<std::uint64_t>(std::ceil(cost + entering(timing)));
  }

  [[nodiscard]] Formula formula(const Parameters& parameters, const Parameters& open,
                                const BoardTiming& timing) {
    const Analysis all = analysis(parameters, open, &timing);
    Formula formula = Model(all, {}).solve_open(entries_);
    formula.base += entering(timing);
    return formula;
  }

 private:
  [[nodiscard]] Analysis analysis(const Parameters& parameters, const Parameters& open,
                                  const BoardTiming* timing) {
    return {image_, sources_, *program_, parameters, inlined_, open, timing};
  }

  // What is entered meanwhile may put every line out of the cache.
  [[nodiscard]] double entering(const BoardTiming& timing) const {
    return times_ * (kEntryCycles + kEntryWords * timing.ram_wait +
                     static_cast<double>(timing.cache_lines) * timing.fetch_wait);
  }

  Image image_;
  SourceCode sources_;
  Entries entries_;
  std::uint32_t times_ = 0;
  std::optional<Program> program_;
  std::set<std::string> inlined_;
};

/// In paper mode it may have any number of points; none with as many is in time.
constexpr std::int64_t kLargestLeaf = 65535;

/// A typical model: what the prices are made with.
core::TickFigures usual_figures() { return {46, 50, 7, 3, 46, 4}; }

Parameters open_parameters() {
  Parameters open{{"delta", 1}};
  const Parameters largest = parameters_of(largest_figures(), core::TickKind::kSurface, 1, true);
  for (const char* const name : core::kTickFigureNames) {
    open[name] = largest.at(name);
  }
  open["points_per_leaf_max"] = kLargestLeaf;
  return open;
}

Parameters divided(Parameters parameters, std::uint32_t pace, const Division& division) {
  const core::GatherSlice& slice = core::kWorkPerTick[pace].slice;
  parameters["gathers"] = division.gathers;
  parameters["passes"] = division.passes;
  parameters["fits"] = division.fits;
  parameters["searches"] = division.searches;
  parameters["slice_corners"] = slice.corners;
  parameters["slice_points"] = slice.points;
  parameters["slice_candidates"] = slice.candidates;
  return parameters;
}

/// One for each division of a tick.
std::vector<Parameters> all_divided(const Parameters& parameters, std::uint32_t pace) {
  std::vector<Parameters> all;
  const auto given = parameters.find("bodies");
  const auto bodies = static_cast<std::uint32_t>(given == parameters.end() ? 1 : given->second);
  for (const Division& division : divisions(pace, std::min(bodies, core::kMaxReachableBodies))) {
    all.push_back(divided(parameters, pace, division));
  }
  return all;
}

PaceCycles cycles_by_pace(Task& task, const BoundOptions& options) {
  PaceCycles cycles{};
  for (std::uint32_t pace = 0; pace < core::kPaces; ++pace) {
    for (const Parameters& parameters : all_divided(options.parameters, pace)) {
      cycles[pace] =
          std::max(cycles[pace], static_cast<double>(task.cycles(parameters, *options.timing)));
    }
  }
  return cycles;
}

}  // namespace

std::vector<Division> divisions(std::uint32_t pace, std::uint32_t bodies) {
  const core::SurfaceWork& work = core::kWorkPerTick[pace];
  std::vector<Division> all(1);
  for (std::uint32_t body = 0; body < bodies; ++body) {
    std::vector<Division> more(all.size() + work.gathers);
    for (std::uint32_t others = 0; others < all.size(); ++others) {
      for (std::uint32_t gathers = 0; gathers <= work.gathers; ++gathers) {
        const std::uint32_t left = work.all - std::min(work.all, core::kGatherWork * gathers);
        const std::uint32_t passes = std::min(work.passes, left);
        const std::uint32_t fits = std::max(passes, 1U) - 1U;
        Division& sum = more[others + gathers];
        sum.gathers = others + gathers;
        sum.passes = std::max(sum.passes, all[others].passes + passes);
        sum.fits = std::max(sum.fits, all[others].fits + fits);
        sum.searches = std::max(sum.searches, all[others].searches + std::min(fits, work.gathers));
      }
    }
    all = std::move(more);
  }
  return all;
}

Bound worst_case(const BoundOptions& options) {
  Task task(options);
  Bound worst;
  for (const Parameters& parameters : all_divided(options.parameters, options.pace)) {
    Bound bound = task.instructions(parameters);
    if (bound.instructions > worst.instructions) {
      worst = std::move(bound);
      worst.parameters = parameters;
    }
  }
  if (options.timing != nullptr) {
    worst.pace_cycles = cycles_by_pace(task, options);
    worst.cycles = static_cast<std::uint64_t>(worst.pace_cycles[options.pace]);
  }
  return worst;
}

double highest_rate(double clock_hz, const PaceCycles& cycles) {
  double below = clock_hz;
  for (std::uint32_t pace = core::kPaces; pace-- > 0;) {
    const double rate = std::min(clock_hz / cycles[pace], below);
    const double lowest = static_cast<double>(core::kPaceRates[pace]);
    if (rate > lowest) {
      return rate;
    }
    below = lowest;
  }
  return 0.0;
}

namespace {

/// Of the whole tick, for each number of bodies that are rendered.
class TickFormulas {
 public:
  TickFormulas(Task& task, const BoardTiming& timing) : task_(task), timing_(timing) {}

  /// A tick without a body is no more than this.
  [[nodiscard]] double base() { return of(core::TickKind::kPaper, 0, 0, {}).base; }

  [[nodiscard]] Formula of(core::TickKind kind, std::uint32_t bodies, std::uint32_t pace,
                           const Division& division) {
    const Parameters parameters =
        divided(parameters_of(usual_figures(), kind, bodies, false), pace, division);
    Formula formula = task_.formula(parameters, open_parameters(), timing_);
    delta_ = std::max(delta_, formula.per["delta"]);
    return formula;
  }

  /// The most that any tick takes longer because the device is a delta.
  [[nodiscard]] double delta() const { return delta_; }

 private:
  Task& task_;
  const BoardTiming& timing_;
  double delta_ = 0.0;
};

/// What one of `bodies` takes of such a tick, where that is more than `cost` says.
void cover(core::TickCost& cost, const Formula& formula, double base, std::uint32_t bodies) {
  const auto raise = [bodies](auto& to, double share) {
    const double each = std::ceil(share / bodies);
    if (each > std::numeric_limits<std::decay_t<decltype(to)>>::max()) {
      throw BoundError("a price of a tick's costs does not fit its 16 bits (widen core::TickCost)");
    }
    to = std::max(to, static_cast<std::decay_t<decltype(to)>>(std::max(each, 0.0)));
  };
  raise(cost.base, formula.base - base);
  for (std::uint32_t i = 0; i < core::kTickFigures; ++i) {
    const auto found = formula.per.find(core::kTickFigureNames[i]);
    raise(cost.per_figure[i], found == formula.per.end() ? 0.0 : found->second);
  }
}

}  // namespace

// Two bodies with so many gathers together are in one row; so is one body with half of them.
core::TickCosts tick_costs(const BoundOptions& options) {
  if (options.timing == nullptr) {
    throw BoundError(options.image.string() + ": costs need a board's timing (say which board)");
  }
  Task task(options);
  TickFormulas formulas(task, *options.timing);
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  const double base = std::floor(formulas.base());
  costs.base = static_cast<std::uint32_t>(base);
  for (std::uint32_t bodies = 1; bodies <= core::kMaxReachableBodies; ++bodies) {
    for (std::uint32_t pace = 0; pace < core::kPaces; ++pace) {
      for (const Division& division : divisions(pace, bodies)) {
        const std::uint32_t row =
            core::first_row(pace) + division.gathers * core::kMaxReachableBodies / bodies;
        for (const core::TickKind kind : {core::TickKind::kSurface, core::TickKind::kMixed}) {
          cover(costs.surface[static_cast<std::uint32_t>(kind)][row],
                formulas.of(kind, bodies, pace, division), base, bodies);
        }
      }
    }
    cover(costs.paper, formulas.of(core::TickKind::kPaper, bodies, 0, {}), base, bodies);
  }
  costs.delta = static_cast<std::uint32_t>(std::ceil(formulas.delta()));
  return costs;
}

namespace {

constexpr const char* kCostsSymbol = "tactree_tick_costs";

std::uint64_t costs_offset(const std::filesystem::path& image) {
  const std::optional<std::uint64_t> offset = Image(image).offset_of(kCostsSymbol);
  if (!offset) {
    throw BoundError(
        fmt::format("{}: has no {} (give an image of ours)", image.string(), kCostsSymbol));
  }
  return *offset;
}

}  // namespace

void embed(const std::filesystem::path& image, const core::TickCosts& costs) {
  const auto offset = static_cast<std::streamoff>(costs_offset(image));
  std::fstream file(image, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(offset);
  file.write(reinterpret_cast<const char*>(&costs), sizeof costs);
  if (!file.flush()) {
    throw BoundError(image.string() + ": cannot be written (check the file's permissions)");
  }
}

core::TickCosts embedded(const std::filesystem::path& image) {
  const auto offset = static_cast<std::streamoff>(costs_offset(image));
  std::ifstream file(image, std::ios::binary);
  core::TickCosts costs;
  file.seekg(offset);
  file.read(reinterpret_cast<char*>(&costs), sizeof costs);
  return costs;
}

Parameters parameters_of(const core::TickFigures& figures, core::TickKind kind,
                         std::uint32_t bodies, bool delta) {
  return {{"points_per_ball_max", figures.points_per_ball_max},
          {"points_per_leaf_max", figures.points_per_leaf_max},
          {"points_per_query_max", core::kLeavesPerQuery * kLargestLeaf},
          {"points_per_slab_max", core::kLeavesPerQuery * kLargestLeaf},
          {"depth", figures.depth},
          {"levels_below", figures.levels_below},
          {"blended_points", figures.blended_points},
          {"blended_materials", figures.blended_materials},
          {"delta", delta ? 1 : 0},
          {"bodies", bodies},
          {"mixed", kind == core::TickKind::kSurface ? 0 : 1},
          {"paper", kind == core::TickKind::kPaper ? 1 : 0}};
}

Parameters parameters_of(const core::BlobHeader& header, core::RenderMode mode,
                         std::uint32_t bodies, core::DeviceKind device) {
  Parameters parameters = parameters_of(core::tick_figures(header), core::tick_kind(header, mode),
                                        bodies, device == core::DeviceKind::kDelta);
  parameters["points_per_query_max"] = header.points_per_query_max;
  parameters["points_per_slab_max"] = header.points_per_slab_max;
  return parameters;
}

core::TickFigures largest_figures() {
  core::BlobHeader header{};
  header.depth = core::kMaxDepth;
  header.material_count = core::kMaxMaterials;
  header.points_per_leaf_max = (1U << core::kLeafHalvings) - 1U;
  header.points_per_ball_max = core::kMaxCandidates;
  return core::tick_figures(header);
}

}  // namespace tactree::bound
