#pragma once
// What a fault means, in two sentences of its page in docs/faults.

#include <string>

#include "tactree/core/safety/faults.hpp"

namespace tactree::viewer {

/// The first sentence of the page, and the first one below "What to do". Empty for kNone.
[[nodiscard]] const std::string& fault_advice(core::Fault fault);

}  // namespace tactree::viewer
