#pragma once
// Buffer views of a glTF file that the extension EXT_meshopt_compression compresses.

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace tactree::builder {

constexpr const char* kMeshopt = "EXT_meshopt_compression";

/// Returns the object of the extension in a buffer view; null if the view is not compressed.
[[nodiscard]] const nlohmann::json* meshopt_of(const nlohmann::json& view);

/// Decodes the buffer view `view`, whose extension names the bytes `packed`. Throws ImportError,
/// which names `who`, before memory is allocated for a count that these bytes cannot hold.
[[nodiscard]] std::vector<unsigned char> decoded_meshopt(const nlohmann::json& view,
                                                         std::span<const unsigned char> packed,
                                                         const std::string& who);

}  // namespace tactree::builder
