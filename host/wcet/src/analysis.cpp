#include "analysis.hpp"

#include <algorithm>

namespace tactree::wcet {

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

std::int64_t NameValues::value(const Expression& expression, const std::string& file) const {
  const std::int64_t value =
      expression.value([&](const std::string& name) { return find(name, file); });
  return std::max<std::int64_t>(value, 0);
}

std::int64_t NameValues::value_with(const Expression& expression, const std::string& file,
                                    const Parameters& values) const {
  const std::int64_t value =
      expression.value([&](const std::string& name) -> std::optional<std::int64_t> {
        if (analysis_.open.largest.contains(name)) {
          return values.contains(name) ? values.at(name) : 0;
        }
        return find(name, file);
      });
  return std::max<std::int64_t>(value, 0);
}

std::optional<std::int64_t> NameValues::argument(const std::string& name) const {
  const auto found = arguments_.find(name);
  return found == arguments_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::int64_t> NameValues::find(const std::string& name,
                                             const std::string& file) const {
  if (const auto own = argument(name)) {
    return own;
  }
  const auto found = analysis_.parameters.find(name);
  return found == analysis_.parameters.end() ? analysis_.sources.constant(file, name)
                                             : std::optional(found->second);
}

}  // namespace tactree::wcet
