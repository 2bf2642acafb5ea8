#include "tactree/core/faults.hpp"

namespace tactree::core {
namespace {

constexpr const char* kNames[kFaultCodes] = {"none",         "emergency-stop",   "encoder-invalid",
                                             "encoder-jump", "not-finite",       "deadline-missed",
                                             "link-lost",    "enable-mismatch",  "unexpected-event",
                                             "motor-fault",  "model-incomplete", "encoder-stuck",
                                             "supply"};

}  // namespace

const char* name_of(Fault fault) {
  const auto code = static_cast<std::uint32_t>(fault);
  return code < kFaultCodes ? kNames[code] : "unknown";
}

}  // namespace tactree::core
