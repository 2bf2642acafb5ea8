#pragma once
// Output files that are written completely or not at all.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::support {

/// Call before any work. Refuses an output that cannot be written, that is also an input, or that
/// is named twice. An empty path is an output that is not wanted. Throws UserError.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs = {});

/// Writes a temporary file beside `file`, flushes it to the disk and renames it. On failure no
/// temporary file remains and an existing file is unchanged. A device or pipe is written in place.
/// Throws UserError.
void write_file(const std::filesystem::path& file, std::span<const std::byte> bytes);
void write_file(const std::filesystem::path& file, std::string_view text);

/// True for a device or pipe, such as /dev/stdout, which is not replaced by a regular file.
[[nodiscard]] bool is_written_in_place(const std::filesystem::path& file);

/// End of the name of a GrowingFile that is not finished.
inline constexpr const char* kIncomplete = ".incomplete";

/// A file that grows for a long time. The bytes are in FILE.incomplete until finish() gives it its
/// name; a device or pipe is written in place. All members but reserve() throw UserError.
class GrowingFile {
 public:
  /// Refuses an existing FILE.incomplete, which holds the data of a program that was cut off.
  explicit GrowingFile(std::filesystem::path file);
  /// Without finish(), FILE.incomplete remains unless nothing was appended.
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// On failure the file has the bytes of the preceding calls only, and can still be finished.
  void append(std::string_view text);
  /// Flushes to the disk and renames.
  void finish();

  /// For a library that writes the file itself instead of append().
  [[nodiscard]] const std::string& temporary() const { return temporary_; }
  /// Allocates disk space up to that size. Returns 0 or the error.
  [[nodiscard]] int reserve(std::uint64_t bytes) const;

 private:
  [[noreturn]] void fail_with_remains(int error) const;

  std::filesystem::path file_;
  std::string temporary_;  // empty: written in place
  int descriptor_ = -1;
  std::uint64_t bytes_ = 0;
};

}  // namespace tactree::support
