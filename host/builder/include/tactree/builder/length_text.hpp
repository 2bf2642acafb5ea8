#pragma once
// Lengths in the messages for a user.

#include <string>

namespace tactree::builder {

/// "3.114 mm": four significant digits, in um below 0.1 mm, mm, m from 1 m, km from 10 km.
[[nodiscard]] std::string length_text(double metres);

}  // namespace tactree::builder
