#pragma once
// Sentences for people about refusals of the core library.

#include <string>

#include "tactree/core/configuration/configuration.hpp"

namespace tactree::support {

/// "limits.slew_N_s is 2000, outside 0.05 .. 1000"; without a field the description of the status.
[[nodiscard]] std::string explain(const core::Refusal& refusal);

}  // namespace tactree::support
