#pragma once
// Files for the tests of the readers, in a temporary folder.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "bytes_of.hpp"
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

using test::bytes_of;

using Corner = std::array<float, 3>;
/// A facet of a binary STL file.
inline std::string facet(const std::array<Corner, 3>& corners) {
  std::string bytes = bytes_of(Corner{0, 0, 1});
  for (const Corner& corner : corners) bytes += bytes_of(corner);
  return bytes + std::string(2, '\0');
}

inline std::uint64_t dropped(const Scan& scan, const std::string& cause) {
  const auto found = scan.dropped.find(cause);
  return found == scan.dropped.end() ? 0 : found->second;
}

}  // namespace tactree::builder
