#pragma once
// A linked image: code, functions, and the source line of each instruction.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::wcet {

struct Function {
  std::string name;  ///< as in the symbol table
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// A line of the source.
struct Place {
  std::string file;  ///< as in the debug information
  std::uint32_t line = 0;
  auto operator<=>(const Place&) const = default;
};

class Image {
 public:
  /// Throws BoundError if the file is not an image of a 32-bit Arm core with symbols and line
  /// numbers.
  explicit Image(const std::filesystem::path& file);
  ~Image();

  [[nodiscard]] const std::map<std::uint32_t, Function>& functions() const { return functions_; }
  /// The function that contains the address; nullptr if there is none.
  [[nodiscard]] const Function* function_at(std::uint32_t address) const;
  /// The function with this symbol or, if there is none, with this name in the source, with or
  /// without its arguments; nullptr if there is none. Throws BoundError if there are several.
  [[nodiscard]] const Function* find(std::string_view name) const;
  /// Bytes from `address` to the end of its section; empty if it is not in the image.
  [[nodiscard]] std::span<const std::uint8_t> bytes_at(std::uint32_t address) const;
  /// Returns false for data between instructions, such as a literal pool.
  [[nodiscard]] bool is_code(std::uint32_t address) const;
  /// Line of an instruction, then the lines of the inlined calls that contain it.
  [[nodiscard]] std::vector<Place> places(std::uint32_t address) const;
  /// Offset of a variable in the file; nullopt if no variable has this symbol.
  [[nodiscard]] std::optional<std::uint64_t> offset_of(std::string_view symbol) const;
  /// Symbols of the functions that are inlined somewhere.
  [[nodiscard]] std::set<std::string> inlined_functions() const;
  /// Source files of the image, as in the debug information.
  [[nodiscard]] std::vector<std::string> source_files() const;
  /// Number of the register, 0 to 3 for r0 to r3, of each named argument of a function. A span is
  /// two words: NAME, NAME_size.
  [[nodiscard]] std::map<std::string, int> arguments(std::uint32_t entry) const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  class Debug;

  void read_symbols();

  std::string name_;
  std::unique_ptr<Debug> debug_;
  std::map<std::uint32_t, Function> functions_;
  std::map<std::string, std::uint32_t> variables_;
  std::map<std::uint32_t, bool> code_;  // true: code begins here; false: data
};

/// The symbol as in the source, or unchanged if it is not a C++ name.
[[nodiscard]] std::string demangled(const std::string& symbol);

}  // namespace tactree::wcet
