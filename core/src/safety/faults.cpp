// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/safety/faults.hpp"

namespace tactree::core {
namespace {

constexpr const char* kNames[kFaultCodes] = {"none",         "emergency-stop",   "encoder-invalid",
                                             "encoder-jump", "not-finite",       "deadline-missed",
                                             "link-lost",    "enable-mismatch",  "unexpected-event",
                                             "motor-fault",  "model-incomplete", "encoder-stuck",
                                             "supply"};

constexpr const char* kLimitNames[kLimits] = {"force",    "slew",    "ramp",      "axis",
                                              "boundary", "waiting", "workspace", "not-homed",
                                              "bodies",   "thermal"};

}  // namespace

const char* name_of(Limit limit) {
  for (std::uint32_t i = 0; i < kLimits; ++i) {  // bound: kLimits
    if (limit_bit(limit) == 1U << i) {
      return kLimitNames[i];
    }
  }
  return "unknown";
}

const char* name_of(Fault fault) {
  const auto code = static_cast<std::uint32_t>(fault);
  return code < kFaultCodes ? kNames[code] : "unknown";
}

}  // namespace tactree::core
