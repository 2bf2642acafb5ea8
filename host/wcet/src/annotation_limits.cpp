#include "annotation_limits.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

/// "tactree::core::Proxy::update(...)" is Proxy::update in an annotation.
bool is_called(const std::string& symbol, const std::string& name) {
  const std::string full = demangled(symbol);
  const std::string plain = full.substr(0, full.find('('));
  return plain == name || plain.ends_with("::" + name);
}

/// True for a part that the compiler has split off a function; its calls are not calls of the
/// function.
bool is_part(const std::string& symbol) {
  return symbol.find(".part.") != std::string::npos || symbol.find(".cold") != std::string::npos;
}

}  // namespace

void AnnotationLimits::add() {
  for (const auto& [entry, own] : flow_.variables()) {
    const AnalysedFunction& function = flow_.function(entry);
    for (std::uint32_t i = 0; i < function.flow.loops.size(); ++i) {
      if (function.bounds[i].counts_with == i) {
        limit_loop(entry, i);
      }
    }
  }
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

void AnnotationLimits::limit_loop(std::uint32_t entry, std::uint32_t number) {
  const AnalysedFunction& function = flow_.function(entry);
  Terms terms;
  for (std::uint32_t i = 0; i < function.flow.loops.size(); ++i) {
    if (function.bounds[i].counts_with == number) {
      add_terms(terms, bodies(entry, i));
    }
  }
  const SourceLoop& source = *function.bounds[number].source;
  limit_to(terms, *source.bound, source.file, flow_.entered(entry, function.flow.loops[number]));
}

// Passes of a loop's body. If the shape of the loop does not determine them, the passes of its back
// edges count, because the condition may be evaluated once more than the body is executed.
Terms AnnotationLimits::bodies(std::uint32_t entry, std::uint32_t number) const {
  const AnalysedFunction& function = flow_.function(entry);
  const NaturalLoop& loop = function.flow.loops[number];
  const LoopBound& bound = function.bounds[number];
  if (bound.shape == LoopShape::kAtEnd) {
    return flow_.passes(entry, loop.header);
  }
  if (bound.shape == LoopShape::kAtStart) {
    std::vector<Edge> inwards;
    for (const std::uint32_t next : function.flow.blocks[loop.header].next) {
      if (loop.blocks.contains(next)) {
        inwards.emplace_back(loop.header, next);
      }
    }
    return flow_.edges(entry, inwards);
  }
  Terms terms = flow_.edges(entry, loop.back);
  if (loop.irregular) {  // the header may be reached before the first pass is complete
    add_terms(terms, flow_.entered(entry, loop), -1.0);
  }
  if (bound.source->tests_last) {  // a body executed n times passes its back edge n - 1 times
    add_terms(terms, flow_.entered(entry, loop));
  }
  return terms;
}

void AnnotationLimits::limit_loop_totals(Groups& groups) {
  std::map<const SourceLoop*, Terms, SourceOrder> passes;
  for (const auto& [entry, own] : flow_.variables()) {
    const AnalysedFunction& function = flow_.function(entry);
    for (std::uint32_t i = 0; i < function.flow.loops.size(); ++i) {
      add_terms(passes[function.bounds[i].source], bodies(entry, i));
    }
  }
  for (const auto& [loop, terms] : passes) {
    for (const Total& total : loop->totals) {
      limit_alone_or_together(terms, total, loop->file, loop->line, groups);
    }
  }
}

// The calls and stores of a statement are executed as often as the statement, wherever the compiler
// puts its other instructions. A statement may call several functions.
void AnnotationLimits::limit_fact(const SourceFact& fact, Groups& groups) {
  std::map<std::uint32_t, Terms> calls;
  Terms stores;
  for (const auto& [entry, own] : flow_.variables()) {
    const ControlFlow& flow = flow_.function(entry).flow;
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      const Block& block = flow.blocks[b];
      if (block.calls && is_of(flow, block.first + std::max(block.count, 1U) - 1, fact)) {
        add_terms(calls[*block.calls], flow_.passes(entry, b));
      }
      if (has_store(flow, block, fact)) {
        add_terms(stores, flow_.passes(entry, b));
      }
    }
  }
  if (!calls.empty() || !stores.empty()) {
    used_facts_.insert(&fact);
  } else if (has_code(fact)) {
    throw BoundError(
        fmt::format("{}:{}: 'at most:' belongs to no call or store: the bound would ignore it "
                    "(write it above the statement with the call; mark a callee gnu::noinline)",
                    fact.file, fact.line));
  }
  if (calls.empty() && !stores.empty()) {
    calls[0] = stores;
  }
  for (const auto& [callee, terms] : calls) {
    limit_alone_or_together(terms, fact.total, fact.file, fact.line, groups);
  }
}

bool AnnotationLimits::is_of(const ControlFlow& flow, std::uint32_t index,
                             const SourceFact& fact) const {
  const auto& places = analysis_.program.lines().at(flow.instructions[index].address);
  return std::any_of(places.begin(), places.end(), [&](const Place& place) {
    return place.file == fact.file && place.line >= fact.line && place.line <= fact.last;
  });
}

/// True if some analysed instruction belongs to the statement.
bool AnnotationLimits::has_code(const SourceFact& fact) const {
  for (const auto& [entry, own] : flow_.variables()) {
    const ControlFlow& flow = flow_.function(entry).flow;
    for (std::uint32_t i = 0; i < flow.instructions.size(); ++i) {
      if (is_of(flow, i, fact)) {
        return true;
      }
    }
  }
  return false;
}

bool AnnotationLimits::has_store(const ControlFlow& flow, const Block& block,
                                 const SourceFact& fact) const {
  for (std::uint32_t i = 0; i < block.count; ++i) {
    if (flow.instructions[block.first + i].store && is_of(flow, block.first + i, fact)) {
      return true;
    }
  }
  return false;
}

void AnnotationLimits::limit_alone_or_together(const Terms& terms, const Total& total,
                                               const std::string& file, std::uint32_t line,
                                               Groups& groups) {
  const std::string where = fmt::format("{}:{}", file, line);
  if (total.together.empty()) {
    limit_total(terms, total, file, where);
    return;
  }
  Group& group = groups[{total.function, total.together}];
  if (group.first != nullptr && group.first->at_most.text() != total.at_most.text()) {
    throw BoundError(fmt::format(
        "{}: '{}' differs from '{}' in {}, which has the same name '{}' (make the limits "
        "equal)",
        where, total.at_most.text(), group.first->at_most.text(), group.where, total.together));
  }
  group.first = &total;
  group.file = file;
  group.where = where;
  add_terms(group.terms, terms, total.weight);
}

// `counted` is at most the total for each call of the function that `total` names.
void AnnotationLimits::limit_total(const Terms& counted, const Total& total,
                                   const std::string& file, const std::string& where) {
  Terms calls;
  bool found = false;
  for (const auto& [entry, own] : flow_.variables()) {
    const std::string& symbol = flow_.function(entry).flow.function.name;
    if (is_called(symbol, total.function)) {
      if (is_part(symbol)) {
        throw BoundError(fmt::format("{}: the compiler has split {} (mark it gnu::noinline)", where,
                                     total.function));
      }
      calls[own.entry] += 1.0;
      found = true;
    }
  }
  const bool inlined =
      std::any_of(analysis_.inlined.begin(), analysis_.inlined.end(),
                  [&](const std::string& symbol) { return is_called(symbol, total.function); });
  if (!found || inlined) {
    throw BoundError(fmt::format(
        "{}: {} is not a function of the image, or is inlined (mark it gnu::noinline, or "
        "correct the name)",
        where, total.function));
  }
  limit_to(counted, total.at_most, file, calls);
}

// counted <= limit * entered.
void AnnotationLimits::limit_to(const Terms& counted, const Expression& limit,
                                const std::string& file, const Terms& entered) {
  Terms terms = counted;
  add_terms(terms, entered, -static_cast<double>(values_.value(limit, file)));
  OpenLimit open{file, program_.at_most(terms, 0.0), counted, entered, 0.0, {}};
  open.fixed = static_cast<double>(values_.value_with(limit, file, {}));
  for (const auto& [name, largest] : analysis_.open.largest) {
    if (limit.mentions(name)) {
      open.per[name] =
          static_cast<double>(values_.value_with(limit, file, {{name, 1}})) - open.fixed;
    }
  }
  if (!open.per.empty()) {
    check_linear(open, limit, file);
    open_.push_back(std::move(open));
  }
}

void AnnotationLimits::check_linear(const OpenLimit& open, const Expression& limit,
                                    const std::string& file) const {
  double sum = open.fixed;
  for (const auto& [name, per] : open.per) {
    sum += per * static_cast<double>(analysis_.open.largest.at(name));
  }
  if (sum != static_cast<double>(values_.value_with(limit, file, analysis_.open.largest))) {
    throw BoundError(fmt::format(
        "{}: '{}' is not linear in the limits of the model (write a sum of multiples of them)",
        file, limit.text()));
  }
}

}  // namespace tactree::wcet
