#include "program.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {

Program::Program(const Image& image, SourceCode& sources, const std::vector<std::uint32_t>& entries)
    : image_(image), lines_(image, sources) {
  collect(entries);
  find_functions_that_return();
  for (auto& [entry, function] : functions_) {
    if (returns(entry)) {
      find_loops(image, function.flow, never_return_);
    }
  }
  keep_reachable(entries);
  std::set<std::uint32_t> done;
  for (const std::uint32_t entry : entries) {
    std::vector<std::uint32_t> path;
    refuse_recursion(entry, path, done);
  }
  for (auto& [entry, function] : functions_) {
    function.bounds = find_loop_bounds(image, function.flow, sources, lines_);
    find_arguments(entry, function);
  }
}

void Program::collect(const std::vector<std::uint32_t>& entries) {
  std::vector<std::uint32_t> open = entries;
  while (!open.empty()) {
    const std::uint32_t entry = open.back();
    open.pop_back();
    if (functions_.contains(entry)) {
      continue;
    }
    AnalysedFunction& function = functions_[entry];
    function.flow = control_flow(image_, image_.functions().at(entry));
    for (const Block& block : function.flow.blocks) {
      if (block.calls) {
        open.push_back(*block.calls);
      }
    }
  }
}

// Fixed point: a function returns if some path to its end calls only functions that return.
void Program::find_functions_that_return() {
  for (const auto& [entry, function] : functions_) {
    never_return_.insert(entry);
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [entry, function] : functions_) {
      if (!returns(entry) && can_return(function.flow)) {
        never_return_.erase(entry);
        changed = true;
      }
    }
  }
}

bool Program::can_return(const ControlFlow& flow) const {
  std::set<std::uint32_t> seen{0};
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Block& block = flow.blocks[open.back()];
    open.pop_back();
    if (block.calls && !returns(*block.calls)) {
      continue;
    }
    if (block.returns) {
      return true;
    }
    for (const std::uint32_t next : block.next) {
      if (seen.insert(next).second) {
        open.push_back(next);
      }
    }
  }
  return false;
}

void Program::keep_reachable(const std::vector<std::uint32_t>& entries) {
  std::set<std::uint32_t> seen;
  std::vector<std::uint32_t> open = entries;
  while (!open.empty()) {
    const std::uint32_t entry = open.back();
    open.pop_back();
    if (!returns(entry) || !seen.insert(entry).second) {
      continue;
    }
    for (const Block& block : functions_.at(entry).flow.blocks) {
      if (block.calls) {
        open.push_back(*block.calls);
      }
    }
  }
  std::erase_if(functions_, [&](const auto& item) { return !seen.contains(item.first); });
}

void Program::refuse_recursion(std::uint32_t entry, std::vector<std::uint32_t>& path,
                               std::set<std::uint32_t>& done) const {
  if (std::find(path.begin(), path.end(), entry) != path.end()) {
    throw BoundError(
        fmt::format("{}: calls itself, directly or through other functions (write a loop)",
                    describe_place(image_, entry)));
  }
  if (!functions_.contains(entry) || done.contains(entry)) {
    return;
  }
  path.push_back(entry);
  for (const Block& block : at(entry).flow.blocks) {
    if (block.calls) {
      refuse_recursion(*block.calls, path, done);
    }
  }
  path.pop_back();
  done.insert(entry);
}

void Program::find_arguments(std::uint32_t entry, AnalysedFunction& function) const {
  for (const auto& [name, number] : image_.arguments(entry)) {
    for (const LoopBound& bound : function.bounds) {
      if (!name.empty() && bound.source->bound->mentions(name)) {
        function.arguments[name] = number;
      }
    }
  }
}

}  // namespace tactree::wcet
