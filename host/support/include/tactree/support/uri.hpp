#pragma once
// Percent-encoding of paths in web addresses (RFC 3986): "a b" <-> "a%20b".

#include <string>
#include <string_view>

namespace tactree::support {

/// A '%' without two hexadecimal digits is kept.
[[nodiscard]] std::string decoded_uri(std::string_view uri);

/// Keeps '/'.
[[nodiscard]] std::string encoded_uri(std::string_view path);

}  // namespace tactree::support
