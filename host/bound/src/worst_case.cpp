#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "linear_program.hpp"
#include "program.hpp"
#include "tactree/bound/bound.hpp"
#include "tactree/bound/bound_error.hpp"
#include "tactree/core/surface.hpp"

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
  const BoardTiming* timing;  ///< what is maximised are cycles; nullptr: instructions
};

/// What the processor does by itself when it enters a function and comes back: registers to the
/// stack and from it, those of the FPU included, whose turn comes with the first instruction that
/// uses them ("lazy stacking").
constexpr double kEntryCycles = 2.0 * (12.0 + 17.0);
constexpr double kEntryWords = 2.0 * 26.0;

double cycles_of(const BoardTiming& timing, const ControlFlow& flow, const Block& block) {
  const Instruction& first = flow.instructions[block.first];
  double cycles = 0.0;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const Instruction& instruction = flow.instructions[block.first + i];
    cycles += instruction.cycles + timing.stack_wait * instruction.stack_words +
              timing.data_wait * instruction.other_words;
  }
  const Instruction& last = flow.instructions[block.first + block.count - 1];
  const std::uint32_t lines = (last.address + last.bytes - 1) / timing.line_bytes -
                              first.address / timing.line_bytes + 1;
  return cycles + timing.fetch_wait * lines;
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

/// The linear program of one analysis.
class Model {
 public:
  Model(const Analysis& analysis, const Parameters& arguments)
      : analysis_(analysis), arguments_(arguments) {}

  Solved solve(const Entries& entries) {
    add_functions(entries);
    connect_calls(entries);
    limit_loops();
    limit_totals();
    limit_facts();
    const LinearProgram::Solution solution = program_.solve();
    if (!solution.bounded) {
      throw BoundError(analysis_.image.name() +
                       ": the bounds beside the loops contradict each other (correct them)");
    }
    return read(solution);
  }

 private:
  struct FunctionVariables {
    int entry = 0;
    std::map<Edge, int> edges;
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
    own.entry = program_.add_variable(gain_of(entry, 0));
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      for (const std::uint32_t next : flow.blocks[b].next) {
        own.edges[{b, next}] = program_.add_variable(gain_of(entry, next));
      }
    }
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      conserve(entry, b);
    }
  }

  /// Instructions of one pass of a block, those of a call with constant arguments included.
  double gain_of(std::uint32_t entry, std::uint32_t b) {
    const Block& block = function(entry).flow.blocks[b];
    double gain = cost_of(function(entry).flow, block);
    if (calls_one_that_returns(block) && !shares_callee(block)) {
      gain += call_with_arguments(entry, b).cost;
    }
    return gain;
  }

  [[nodiscard]] double cost_of(const ControlFlow& flow, const Block& block) const {
    if (analysis_.timing == nullptr || block.count == 0) {
      return block.count;
    }
    return cycles_of(*analysis_.timing, flow, block);
  }

  /// A constant; or what this function itself was called with; or what the source says.
  [[nodiscard]] std::optional<std::int64_t> argument(std::uint32_t entry, std::uint32_t b,
                                                     int number,
                                                     const std::string& wanted) const {
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
    std::optional<std::int64_t> least;  // where the calls inlined around it say more, that is true too
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
    const std::int64_t value = expression.value([&](const std::string& name) {
      for (const Parameters* names : {&arguments_, &analysis_.parameters}) {
        const auto found = names->find(name);
        if (found != names->end()) {
          return std::optional(found->second);
        }
      }
      return analysis_.sources.constant(file, name);
    });
    return std::max<std::int64_t>(value, 0);
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
    const auto limit = static_cast<double>(value_of(*source.bound, source.file));
    add(terms, entered(entry, f.flow.loops[number]), -limit);
    program_.at_most(terms, 0.0);
  }

  /// sum of `what` <= so often for each call of the function that `total` names.
  void limit_total(const Terms& what, const Total& total, const std::string& file,
                   const std::string& where) {
    Terms terms = what;
    const auto limit = static_cast<double>(value_of(total.at_most, file));
    bool found = false;
    for (const auto& [entry, own] : variables_) {
      const std::string& symbol = function(entry).flow.function.name;
      if (is_called(symbol, total.function)) {
        if (is_part(symbol)) {
          throw BoundError(fmt::format("{}: the compiler has divided {} (mark it gnu::noinline)",
                                       where, total.function));
        }
        terms[own.entry] -= limit;
        found = true;
      }
    }
    const bool inlined =
        std::any_of(analysis_.inlined.begin(), analysis_.inlined.end(),
                    [&](const std::string& symbol) { return is_called(symbol, total.function); });
    if (!found || inlined) {
      throw BoundError(fmt::format("{}: {} is no function of its own in the image (mark it "
                                   "gnu::noinline, or correct the name)",
                                   where, total.function));
    }
    program_.at_most(terms, 0.0);
  }

  void limit_totals() {
    std::map<const SourceLoop*, Terms> totals;
    for (const auto& [entry, own] : variables_) {
      const AnalysedFunction& f = function(entry);
      for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
        if (f.bounds[i].source->total) {
          add(totals[f.bounds[i].source], bodies(entry, i));
        }
      }
    }
    for (const auto& [loop, terms] : totals) {
      limit_total(terms, *loop->total, loop->file, fmt::format("{}:{}", loop->file, loop->line));
    }
  }

  void limit_facts() {
    for (const auto& [name, file] : analysis_.sources.files()) {
      for (const SourceFact& fact : file.facts) {
        limit_fact(fact);
      }
    }
  }

  // A statement's calls and stores are executed no more often than it is, wherever the compiler has
  // put its other instructions.
  void limit_fact(const SourceFact& fact) {
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
    const std::string where = fmt::format("{}:{}", fact.file, fact.line);
    if (!calls.empty() || !stores.empty()) {
      held_.insert(&fact);
    }
    if (calls.empty() && !stores.empty()) {
      limit_total(stores, fact.total, fact.file, where);
    }
    for (const auto& [callee, terms] : calls) {
      limit_total(terms, fact.total, fact.file, where);
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

  void note_loop(std::uint32_t entry, std::uint32_t number,
                 const LinearProgram::Solution& solution, Solved& solved) const {
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

std::vector<EntryPoint> tick_entries() {
  return {{"tactree_tick", 1}, {"tactree_deadline", 2}};
}

Bound worst_case(const BoundOptions& options) {
  const Image image(options.image);
  SourceCode sources(options.sources);
  for (const std::string& file : image.source_files()) {
    (void)sources.name_of(file);
  }
  std::vector<std::uint32_t> addresses;
  Entries entries;
  for (const EntryPoint& entry : options.entries) {
    const Function* const function = image.find(entry.function);
    if (function == nullptr) {
      throw BoundError(fmt::format("{}: has no function {} (give an image of ours)", image.name(),
                                   entry.function));
    }
    addresses.push_back(function->begin);
    entries[function->begin] += entry.times;
  }
  Program program(image, sources, addresses);
  Analysis analysis{image, sources, program, options.parameters, image.inlined_functions(), nullptr};
  Bound bound = to_bound(sources, solve(analysis, entries, {}));
  for (const std::uint32_t entry : program.endings()) {
    bound.endings.push_back({entry, image.functions().at(entry).end, 0, 0.0});
  }
  if (options.timing != nullptr) {
    analysis.timing = options.timing;
    double cycles = solve(analysis, entries, {}).cost;
    for (const EntryPoint& entry : options.entries) {
      cycles += entry.times * (kEntryCycles + kEntryWords * options.timing->stack_wait);
    }
    bound.cycles = static_cast<std::uint64_t>(std::ceil(cycles));
  }
  return bound;
}

Parameters parameters_of(const core::BlobHeader& header, core::RenderMode mode,
                         std::uint32_t bodies) {
  const bool is_mixed = header.profile == static_cast<std::uint32_t>(core::Profile::kPaper);
  return {{"depth", header.depth},
          {"points_per_leaf_max", header.points_per_leaf_max},
          {"points_per_ball_max", header.points_per_ball_max},
          {"points_per_query_max", header.points_per_query_max},
          {"levels_below", header.depth - header.directory_level},
          {"materials", header.material_count},
          {"mixed", is_mixed ? 1 : 0},
          {"paper", mode == core::RenderMode::kPaper ? 1 : 0},
          {"bodies", bodies}};
}

Parameters largest_parameters(core::RenderMode mode, std::uint32_t bodies) {
  // A query's eight leaves hold no more than a ball of their size: no more than that is known.
  core::BlobHeader header{};
  header.profile = static_cast<std::uint32_t>(core::Profile::kPaper);
  header.depth = core::kMaxDepth;
  header.material_count = core::kMaxMaterials;
  header.points_per_leaf_max = core::kMaxCandidates;
  header.points_per_ball_max = core::kMaxCandidates;
  header.points_per_query_max = core::kLeavesPerQuery * core::kMaxCandidates;
  return parameters_of(header, mode, bodies);
}

}  // namespace tactree::bound
