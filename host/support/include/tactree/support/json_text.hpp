#pragma once
// JSON as text. Names of files and models may contain bytes that are not UTF-8.

#include <nlohmann/json.hpp>
#include <string>

namespace tactree::support {

/// Converts any nlohmann::basic_json to text, indented by two. Bytes that are not UTF-8 become
/// U+FFFD.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tactree::support
