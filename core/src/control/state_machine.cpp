// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/control/state_machine.hpp"

namespace tactree::core {
namespace {

constexpr const char* kNames[kStates] = {"boot", "no-model", "idle", "armed", "active", "fault"};

}  // namespace

const char* name_of(State state) {
  const auto index = static_cast<std::uint32_t>(state);
  return index < kStates ? kNames[index] : "unknown";
}

}  // namespace tactree::core
