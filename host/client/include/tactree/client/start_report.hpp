#pragma once
// The start of a board as text: failures and hints.

#include <string>
#include <vector>

#include "tactree/core/link/wire/messages.hpp"

namespace tactree::client {

/// Returns one sentence per problem, with the hint if there is one; empty if there are no
/// problems.
[[nodiscard]] std::vector<std::string> complaints(const core::wire::ReadStartReply& start);

}  // namespace tactree::client
