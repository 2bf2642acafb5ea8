#pragma once
// Numbers as the bytes of a file.

#include <algorithm>
#include <cstring>
#include <string>

namespace tactree::test {

/// The bytes of a value, in the opposite byte order if `swap`.
template <typename Value>
std::string bytes_of(Value value, bool swap = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

}  // namespace tactree::test
