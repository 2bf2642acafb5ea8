#pragma once
// JSON as text, whatever bytes are in it: names of files and models need not be UTF-8.

#include <nlohmann/json.hpp>
#include <string>

namespace tactree::cli {

/// Of any nlohmann::basic_json; what is no UTF-8 becomes U+FFFD.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tactree::cli
