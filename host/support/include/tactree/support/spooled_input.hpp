#pragma once
// Copies a stream to a file, for readers that need its size or read it twice.

#include <cstdint>
#include <filesystem>
#include <functional>

namespace tactree::support {

/// The name of standard input on a command line, and its name in messages.
inline constexpr const char* kStandardInput = "-";
inline constexpr const char* kStandardInputName = "standard input";

/// Space that a copy must leave free in its folder.
inline constexpr std::uint64_t kSpoolReserve = std::uint64_t{64} << 20;

/// Bytes that can be written in a folder; 0 if the number is unknown.
using FreeSpace = std::function<std::uint64_t(const std::filesystem::path& folder)>;
[[nodiscard]] std::uint64_t free_space(const std::filesystem::path& folder);

/// A copy, in a folder, of all bytes that a descriptor delivers. The copy has no name, so the
/// system deletes it when the program ends for any reason.
class SpooledInput {
 public:
  /// Copies the bytes, by default from standard input to the folder for temporary files (TMPDIR,
  /// else /tmp). Throws UserError if the descriptor is a terminal, if reading or writing fails, or
  /// if less than kSpoolReserve would stay free.
  explicit SpooledInput(int descriptor = 0, const std::filesystem::path& folder = default_folder(),
                        const FreeSpace& space = free_space);
  ~SpooledInput();
  SpooledInput(const SpooledInput&) = delete;
  SpooledInput& operator=(const SpooledInput&) = delete;

  /// Path of the copy, valid in this process and its children.
  [[nodiscard]] std::filesystem::path path() const;

  [[nodiscard]] static std::filesystem::path default_folder();

 private:
  void copy(int from, const std::filesystem::path& folder, const FreeSpace& space) const;

  int copy_ = -1;
};

}  // namespace tactree::support
