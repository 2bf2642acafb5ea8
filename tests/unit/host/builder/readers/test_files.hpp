#pragma once
// Files for the tests of the readers, in a temporary folder.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

class TestFiles : public test::FolderTest {
 protected:
  Scan read(std::string_view bytes, const std::string& name = "scan") {
    return read_scan(write(name, bytes));
  }

  /// The message of the refusal; a test failure and "" without one.
  std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
    return test::message_of<ReadError>([&] {
      const Scan scan = read_scan(path, options);
      ADD_FAILURE() << path << " was read: " << scan.positions.size() << " points";
    });
  }
  /// With columns as named by the user.
  static ReadOptions columns(std::string_view text) {
    ReadOptions options;
    options.columns = parse_columns(text);
    return options;
  }
  std::string refusal_of(std::string_view bytes, const std::string& name = "scan") {
    return refusal(write(name, bytes));
  }
};

/// Expects `text` to contain each of the parts.
template <typename... Parts>
void expect_parts(const std::string& text, const Parts&... parts) {
  for (const std::string& part : {std::string(parts)...}) {
    EXPECT_NE(text.find(part), std::string::npos) << "no \"" << part << "\" in: " << text;
  }
}

/// The bytes of a number, in the other byte order when `swap`.
template <typename Number>
std::string bytes_of(Number number, bool swap = false) {
  std::string bytes(sizeof number, '\0');
  std::memcpy(bytes.data(), &number, sizeof number);
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::uint64_t dropped(const Scan& scan, const std::string& cause) {
  const auto found = scan.dropped.find(cause);
  return found == scan.dropped.end() ? 0 : found->second;
}

}  // namespace tactree::builder
