#pragma once
// The token that programs must send to a shared board (tactree serve).

#include <string>

namespace tactree::cli {

/// The token in `file`; without a file a new one, but none for an address of this machine only.
/// Throws support::UserError if the file has no token of at least 16 letters, digits, "-" and "_".
[[nodiscard]] std::string share_token(const std::string& file, const std::string& address);

}  // namespace tactree::cli
