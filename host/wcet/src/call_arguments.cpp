#include "call_arguments.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

std::uint32_t call_address(const ControlFlow& flow, std::uint32_t b) {
  const Block& block = flow.blocks[b];
  return flow.instructions[block.first + std::max(block.count, 1U) - 1].address;
}

// The call may be inlined into other calls, which have their own annotations. All of them hold, so
// the minimum is returned.
std::optional<std::int64_t> annotated_argument(const Analysis& analysis, const NameValues& values,
                                               std::uint32_t address, const std::string& name) {
  std::optional<std::int64_t> least;
  for (const Place& place : analysis.program.lines().at(address)) {
    const SourceFile* const file = analysis.sources.find(place.file);
    if (file == nullptr) {
      continue;
    }
    for (const SourceArgument& argument : file->arguments) {
      if (argument.line == place.line && argument.name == name) {
        const std::int64_t value = values.value(argument.at_most, argument.file);
        least = std::min(least.value_or(value), value);
      }
    }
  }
  return least;
}

}  // namespace

Parameters call_arguments(const Analysis& analysis, const NameValues& values, std::uint32_t entry,
                          std::uint32_t b) {
  const AnalysedFunction& caller = analysis.program.at(entry);
  const AnalysedFunction& callee = analysis.program.at(*caller.flow.blocks[b].calls);
  const std::uint32_t address = call_address(caller.flow, b);
  const auto value_of = [&](const std::string& name, int number) -> std::optional<std::int64_t> {
    const Argument given = caller.flow.argument(b, number);
    for (const auto& [own_name, own_number] : caller.arguments) {
      if (given.passed_on == own_number && values.argument(own_name)) {
        return values.argument(own_name);
      }
    }
    return given.constant ? std::optional<std::int64_t>(*given.constant)
                          : annotated_argument(analysis, values, address, name);
  };
  Parameters arguments;
  for (const auto& [name, number] : callee.arguments) {
    const auto value = value_of(name, number);
    if (!value) {
      throw BoundError(
          fmt::format("{}: calls {} with an argument '{}' that is not a constant (pass a constant, "
                      "or add `with: {} <= ...` beside the call)",
                      describe_place(analysis.image, address), demangled(callee.flow.function.name),
                      name, name));
    }
    arguments[name] = *value;
  }
  return arguments;
}

}  // namespace tactree::wcet
