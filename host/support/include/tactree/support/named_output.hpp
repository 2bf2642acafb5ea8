#pragma once
// The output of a command: a file, or standard output, whose name is "-" or /dev/stdout.

#include <cstddef>
#include <filesystem>
#include <span>

namespace tactree::support {

/// If it is standard output, text that the program prints goes to standard error from the
/// construction on. At most one such object in a program.
class NamedOutput {
 public:
  /// Throws UserError if it is standard output, and that is a terminal.
  explicit NamedOutput(const std::filesystem::path& name);
  ~NamedOutput();
  NamedOutput(const NamedOutput&) = delete;
  NamedOutput& operator=(const NamedOutput&) = delete;

  /// For check_outputs(): empty if it is standard output.
  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

  /// Throws UserError.
  void write(std::span<const std::byte> bytes) const;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;  // of standard output
};

}  // namespace tactree::support
