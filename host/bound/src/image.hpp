#pragma once
// A linked image: its code, its functions, and which line of source each instruction is of.

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

namespace tactree::bound {

struct Function {
  std::string name;  ///< as in the symbol table
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// A place in the source.
struct Place {
  std::string file;  ///< as the compiler calls it
  std::uint32_t line = 0;
  auto operator<=>(const Place&) const = default;
};

class Image {
 public:
  /// Throws BoundError, here and below, on what is no image of a 32-bit Arm core with line numbers.
  explicit Image(const std::filesystem::path& file);
  ~Image();

  [[nodiscard]] const std::map<std::uint32_t, Function>& functions() const { return functions_; }
  /// The function whose code holds the address; nullptr: none does.
  [[nodiscard]] const Function* function_at(std::uint32_t address) const;
  /// nullptr: there is no such symbol.
  [[nodiscard]] const Function* find(std::string_view symbol) const;
  /// The bytes from `address` to the end of their section; empty: not in the image.
  [[nodiscard]] std::span<const std::uint8_t> bytes_at(std::uint32_t address) const;
  /// Is there code at the address, or data among the code?
  [[nodiscard]] bool is_code(std::uint32_t address) const;
  /// The line of an instruction, then the lines of the calls that were inlined around it.
  [[nodiscard]] std::vector<Place> places(std::uint32_t address) const;
  /// Where in the file a variable is stored; nothing: there is none of this name.
  [[nodiscard]] std::optional<std::uint64_t> offset_of(std::string_view symbol) const;
  /// Functions that were inlined anywhere, by their symbols' names.
  [[nodiscard]] std::set<std::string> inlined_functions() const;
  /// Every source file of the image.
  [[nodiscard]] std::vector<std::string> source_files() const;
  /// The registers r0 to r3 that hold the named arguments of the function that begins there.
  [[nodiscard]] std::map<std::string, int> arguments(std::uint32_t entry) const;
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  class Debug;

  void read_symbols();

  std::string name_;
  std::unique_ptr<Debug> debug_;
  std::map<std::uint32_t, Function> functions_;
  std::map<std::string, std::uint32_t> variables_;
  std::map<std::uint32_t, bool> code_;  // from here on: code, or data
};

/// A symbol's name for people.
[[nodiscard]] std::string demangled(const std::string& symbol);

}  // namespace tactree::bound
