#pragma once
// A stream as a file, for readers that need its size or read it twice.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace tactree::support {

/// The name that stands for standard input on a command line, and its name in messages.
inline constexpr const char* kStandardInput = "-";
inline constexpr const char* kStandardInputName = "standard input";

/// Space that stays free in the folder of the copy.
inline constexpr std::uint64_t kSpoolReserve = std::uint64_t{64} << 20;

/// Bytes that can be written in a folder; 0 if that is unknown.
using FreeSpace = std::function<std::uint64_t(const std::filesystem::path& folder)>;
[[nodiscard]] std::uint64_t free_space(const std::filesystem::path& folder);

/// A copy of all that a descriptor gives, in a folder. It has no name there, so that it vanishes
/// with the program, however that ends.
class SpooledInput {
 public:
  /// Copies, by default standard input to the folder for temporary files (TMPDIR, else /tmp).
  /// Throws UserError if the descriptor is a terminal, if it fails, or if less than
  /// kSpoolReserve would stay free.
  explicit SpooledInput(int descriptor = 0, const std::filesystem::path& folder = default_folder(),
                        const FreeSpace& space = free_space);
  ~SpooledInput();
  SpooledInput(const SpooledInput&) = delete;
  SpooledInput& operator=(const SpooledInput&) = delete;

  /// A path to the copy, for this process and its children.
  [[nodiscard]] std::filesystem::path path() const;

  [[nodiscard]] static std::filesystem::path default_folder();

 private:
  void copy(int from, const std::filesystem::path& folder, const FreeSpace& space) const;

  int copy_ = -1;
};

}  // namespace tactree::support
