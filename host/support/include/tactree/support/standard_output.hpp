#pragma once
// An output file that is standard output, named "-".

#include <cstddef>
#include <filesystem>
#include <span>

namespace tactree::support {

/// True for "-" and /dev/stdout.
[[nodiscard]] bool is_standard_output(const std::filesystem::path& file);

/// Takes standard output for the bytes of a file. From its construction on, text that the program
/// prints goes to standard error. At most one object in a program.
class StandardOutput {
 public:
  /// Throws UserError if standard output is a terminal.
  StandardOutput();
  ~StandardOutput();
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Throws UserError.
  void write(std::span<const std::byte> bytes) const;

 private:
  int descriptor_;
};

}  // namespace tactree::support
