#include "longest_path.hpp"

#include <algorithm>
#include <utility>

#include "annotation_limits.hpp"
#include "flow_constraints.hpp"
#include "linear_program.hpp"
#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

// The points in the support are part of those in the ball.
constexpr const char* kPointsInBall = "points_per_ball_max";
constexpr const char* kPointsInSupport = "points_per_support_max";

class PathProgram {
 public:
  PathProgram(const Analysis& analysis, const Entries& entries, const Parameters& arguments)
      : analysis_(analysis),
        values_(analysis, arguments),
        flow_(analysis, values_, program_),
        limits_(analysis, values_, flow_, program_) {
    flow_.add(entries);
    limits_.add();
  }

  [[nodiscard]] WorstPath worst_path() const {
    if (!limits_.open().empty()) {
      throw BoundError(limits_.open()[0].where +
                       ": uses a limit of the model in a function whose bounds depend on arguments "
                       "(use only the arguments)");
    }
    return read(solution());
  }

  // An open limit, counted <= (fixed + sum of per * value) * entered, is replaced by a price: the
  // dual value of its row at the reference parameters. The counted passes cost this price, the
  // entries earn it, whatever the values of the open parameters are. By weak duality the worst case
  // is at most the largest gain at the minimum values plus, for each open parameter, its excess
  // over the minimum times the largest gain of the terms per unit of it. This holds for any prices;
  // those of the optimum make it tight.
  [[nodiscard]] CostFormula formula() {
    const LinearProgram::Solution reference = solution();
    std::vector<double> at_least = program_.gains();
    std::map<std::string, std::vector<double>> grants;
    for (const OpenLimit& limit : limits_.open()) {
      const double price = std::max(reference.price[limit.row], 0.0);
      for (const auto& [variable, coefficient] : limit.counted) {
        at_least[static_cast<std::size_t>(variable)] -= price * coefficient;
      }
      for (const auto& [variable, coefficient] : limit.entered) {
        at_least[static_cast<std::size_t>(variable)] += price * limit.fixed * coefficient;
        for (const auto& [name, per] : limit.per) {
          auto& grant = grants[name];
          grant.resize(at_least.size());
          grant[static_cast<std::size_t>(variable)] += price * per * coefficient;
        }
      }
      widen(limit);
    }
    std::vector<double>& in_support = grants[kPointsInSupport];
    const std::vector<double>& in_ball = grants[kPointsInBall];
    for (auto& [name, grant] : grants) {
      grant.resize(at_least.size());
      const auto least = static_cast<double>(analysis_.open.least.at(name));
      for (std::size_t i = 0; i < grant.size(); ++i) {
        at_least[i] += least * grant[i];
      }
    }
    CostFormula formula;
    formula.base = largest(std::move(at_least));
    // A point in the support has the price of the ball, too. Both on one path cost less than each
    // on its most expensive path.
    for (std::size_t i = 0; i < in_ball.size(); ++i) {
      in_support[i] += in_ball[i];
    }
    for (auto& [name, grant] : grants) {
      formula.per[name] = largest(std::move(grant));
    }
    formula.per[kPointsInSupport] -= formula.per[kPointsInBall];
    return formula;
  }

 private:
  [[nodiscard]] LinearProgram::Solution solution() const {
    LinearProgram::Solution solution = program_.solve();
    if (!solution.bounded) {
      throw BoundError(analysis_.image.name() +
                       ": the annotations contradict each other (correct the bounds)");
    }
    return solution;
  }

  double largest(std::vector<double> gains) {
    program_.set_gains(std::move(gains));
    return solution().gain;
  }

  /// Replaces the reference values by the maximum values, which bound the passes for any values.
  void widen(const OpenLimit& limit) {
    double largest = limit.fixed;
    for (const auto& [name, per] : limit.per) {
      largest += per * static_cast<double>(analysis_.open.largest.at(name));
    }
    Terms terms = limit.counted;
    add_terms(terms, limit.entered, -largest);
    program_.replace(limit.row, terms);
  }

  static double sum(const Terms& terms, const LinearProgram::Solution& solution) {
    double result = 0.0;
    for (const auto& [variable, coefficient] : terms) {
      result += coefficient * solution.x[static_cast<std::size_t>(variable)];
    }
    return result;
  }

  [[nodiscard]] WorstPath read(const LinearProgram::Solution& solution) const {
    WorstPath path;
    path.used_facts = limits_.used_facts();
    path.cost = solution.gain;
    for (const auto& [entry, own] : flow_.variables()) {
      const AnalysedFunction& f = flow_.function(entry);
      FunctionOnPath& on_path = path.functions[entry];
      on_path.name = demangled(f.flow.function.name);
      on_path.calls += solution.x[static_cast<std::size_t>(own.entry)];
      for (std::uint32_t b = 0; b < f.flow.blocks.size(); ++b) {
        const double times = sum(flow_.passes(entry, b), solution);
        on_path.instructions += times * f.flow.blocks[b].count;
        add_block(f.flow, b, times, path);
        const auto call = flow_.calls().find({entry, b});
        if (call != flow_.calls().end()) {
          add_call(call->second, times, path);
        }
      }
      for (std::uint32_t i = 0; i < f.flow.loops.size(); ++i) {
        add_loop(entry, i, solution, path);
      }
    }
    return path;
  }

  static void add_block(const ControlFlow& flow, std::uint32_t b, double times, WorstPath& path) {
    const Block& block = flow.blocks[b];
    if (block.count == 0) {
      return;
    }
    const std::uint32_t begin = flow.instructions[block.first].address;
    const Instruction& last = flow.instructions[block.first + block.count - 1];
    BlockOnPath& on_path = path.blocks[begin];
    on_path.address = begin;
    on_path.end = last.address + last.bytes;
    on_path.instructions = block.count;
    on_path.times += times;
  }

  void add_loop(std::uint32_t entry, std::uint32_t number, const LinearProgram::Solution& solution,
                WorstPath& path) const {
    const AnalysedFunction& f = flow_.function(entry);
    const NaturalLoop& loop = f.flow.loops[number];
    const SourceLoop& source = *f.bounds[number].source;
    path.loops.push_back({source.file, source.line, demangled(f.flow.function.name),
                          f.flow.instructions[f.flow.blocks[loop.header].first].address,
                          source.bound->text(), values_.value(*source.bound, source.file),
                          sum(flow_.passes(entry, loop.header), solution)});
  }

  static void add_call(const WorstPath& call, double times, WorstPath& path) {
    for (const auto& [entry, f] : call.functions) {
      FunctionOnPath& on_path = path.functions[entry];
      on_path.name = f.name;
      on_path.calls += times * f.calls;
      on_path.instructions += times * f.instructions;
    }
    for (const auto& [address, block] : call.blocks) {
      BlockOnPath& on_path = path.blocks[address];
      on_path.address = address;
      on_path.end = block.end;
      on_path.instructions = block.instructions;
      on_path.times += times * block.times;
    }
    for (LoopOnPath loop : call.loops) {
      loop.total *= times;
      path.loops.push_back(std::move(loop));
    }
  }

  const Analysis& analysis_;
  NameValues values_;
  LinearProgram program_;
  FlowConstraints flow_;
  AnnotationLimits limits_;
};

}  // namespace

WorstPath longest_path(const Analysis& analysis, const Entries& entries,
                       const Parameters& arguments) {
  return PathProgram(analysis, entries, arguments).worst_path();
}

CostFormula cost_formula(const Analysis& analysis, const Entries& entries) {
  return PathProgram(analysis, entries, {}).formula();
}

}  // namespace tactree::wcet
