#include "tactree/support/explain.hpp"

#include <fmt/core.h>

namespace tactree::support {

std::string explain(const core::Refusal& refusal) {
  if (refusal.field[0] == '\0') {
    return core::describe(refusal.status);
  }
  const std::string axis = refusal.axis < 0 ? "" : fmt::format("[{}]", refusal.axis);
  return fmt::format("{}{} is {:.6g}, outside {:.6g} .. {:.6g}", refusal.field, axis, refusal.value,
                     refusal.min, refusal.max);
}

}  // namespace tactree::support
