#pragma once
// The start of a board as text: what failed, and the remedy.

#include <string>
#include <vector>

#include "tactree/core/link/wire/messages.hpp"

namespace tactree::client {

/// A sentence for each thing that is not well, with its remedy. None: all is.
[[nodiscard]] std::vector<std::string> complaints(const core::wire::ReadStartReply& start);

}  // namespace tactree::client
