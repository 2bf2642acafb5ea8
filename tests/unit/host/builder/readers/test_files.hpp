#pragma once
// Files for the tests of the readers, in a temporary folder.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

class TestFiles : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("tactree_readers_" + std::to_string(::getpid()) + "_" + test->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, std::string_view bytes) {
    const std::filesystem::path path = folder_ / name;
    // Some file systems wait for the disk when a file is overwritten.
    std::filesystem::remove(path);
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path;
  }

  Scan read(std::string_view bytes, const std::string& name = "scan") {
    return read_scan(write(name, bytes));
  }

  /// The message of the refusal; a test failure and "" without one.
  std::string refusal(const std::filesystem::path& path, const ReadOptions& options = {}) {
    try {
      const Scan scan = read_scan(path, options);
      ADD_FAILURE() << path << " was read: " << scan.positions.size() << " points";
    } catch (const ReadError& error) {
      return error.what();
    }
    return "";
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

  std::filesystem::path folder_;
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
