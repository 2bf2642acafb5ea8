#include "flow_constraints.hpp"

#include <optional>

#include "call_arguments.hpp"

namespace tactree::wcet {

void FlowConstraints::add(const Entries& entries) {
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
  connect_calls(entries);
}

bool FlowConstraints::calls_one_that_returns(const Block& block) const {
  return block.calls && analysis_.program.returns(*block.calls);
}

bool FlowConstraints::shares_callee(const Block& block) const {
  return calls_one_that_returns(block) && function(*block.calls).arguments.empty();
}

void FlowConstraints::add_function(std::uint32_t entry) {
  const ControlFlow& flow = function(entry).flow;
  const CachedLoops cached = costs_.cached_loops(flow);
  FunctionVariables& own = variables_[entry];
  own.entry =
      program_.add_variable(cost_of(entry, cached, 0) + BlockCosts::load(cached, std::nullopt, 0));
  for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
    for (const std::uint32_t next : flow.blocks[b].next) {
      own.edges[{b, next}] = program_.add_variable(
          cost_of(entry, cached, next) + BlockCosts::load(cached, b, next) -
          costs_.saved_by_falling(flow, cached, b, next) - costs_.saved_by_staying(flow, b, next));
    }
  }
  for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
    conserve(entry, b);
  }
}

// Cost of one pass of a block, including its call if that is solved separately.
double FlowConstraints::cost_of(std::uint32_t entry, const CachedLoops& cached, std::uint32_t b) {
  const ControlFlow& flow = function(entry).flow;
  const Block& block = flow.blocks[b];
  const double cost = costs_.pass(flow, cached, b);
  if (!calls_one_that_returns(block) || shares_callee(block)) {
    return cost;
  }
  auto known = calls_.find({entry, b});
  if (known == calls_.end()) {
    const Parameters arguments = call_arguments(analysis_, values_, entry, b);
    known =
        calls_
            .emplace(std::pair(entry, b), longest_path(analysis_, {{*block.calls, 1.0}}, arguments))
            .first;
  }
  return cost + known->second.cost;
}

// Flow ends where the function returns. Nothing flows into a block that calls a function which
// never returns, because no tick takes that path.
void FlowConstraints::conserve(std::uint32_t entry, std::uint32_t b) {
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

// A function is entered as often as it is called.
void FlowConstraints::connect_calls(const Entries& entries) {
  std::map<std::uint32_t, Terms> calls;
  for (const auto& [entry, own] : variables_) {
    calls[entry][own.entry] += 1.0;
    const ControlFlow& flow = function(entry).flow;
    for (std::uint32_t b = 0; b < flow.blocks.size(); ++b) {
      if (shares_callee(flow.blocks[b])) {
        add_terms(calls[*flow.blocks[b].calls], passes(entry, b), -1.0);
      }
    }
  }
  for (const auto& [entry, terms] : calls) {
    const auto times = entries.find(entry);
    program_.equal(terms, times == entries.end() ? 0.0 : times->second);
  }
}

Terms FlowConstraints::passes(std::uint32_t entry, std::uint32_t b) const {
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

Terms FlowConstraints::edges(std::uint32_t entry, const std::vector<Edge>& wanted) const {
  Terms terms;
  for (const Edge& edge : wanted) {
    terms[variables_.at(entry).edges.at(edge)] += 1.0;
  }
  return terms;
}

Terms FlowConstraints::entered(std::uint32_t entry, const NaturalLoop& loop) const {
  Terms terms = edges(entry, loop.entries);
  if (loop.blocks.contains(0)) {
    terms[variables_.at(entry).entry] += 1.0;
  }
  return terms;
}

}  // namespace tactree::wcet
