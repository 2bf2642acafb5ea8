#pragma once
// The bytes of a file.

#include <cstddef>
#include <limits>
#include <string>

namespace tactree::builder {

/// The first bytes of a file, at most `most`; fewer if it cannot be read.
[[nodiscard]] std::string file_bytes(const std::string& file,
                                     std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace tactree::builder
