#pragma once
// The annotations of the sources, by file. docs/BOUND.md, "Annotations", defines the language:
//   for (...) {  // bound: EXPRESSION [, total TOTAL]
//   // total: TOTAL      on a separate line above a loop with a bound
//   call(...);   // at most: TOTAL
//   call(...);   // with: ARGUMENT <= EXPRESSION
//   // memory: RAM       on a separate line: for the file
//   value = table[i];    // memory: flash
// TOTAL is EXPRESSION per FUNCTION [together NAME [as WEIGHT]]. A remark may follow in parentheses
// or after a semicolon.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tactree/wcet/expression.hpp"

namespace tactree::wcet {

/// Limit of executions in one call of a function.
struct Total {
  Expression at_most;
  std::string function;      ///< qualified, without the outermost namespaces: Proxy::update
  std::string together;      ///< statements with the same name are counted together; empty: alone
  std::uint32_t weight = 1;  ///< executions that one execution counts as
};

struct SourceLoop {
  std::string file;
  std::uint32_t line = 0;  ///< first line of its head
  std::uint32_t last = 0;  ///< last line of its body
  std::vector<std::uint32_t> head;
  bool tests_last = false;  ///< do {} while ()
  /// The condition is one comparison, which is one branch in the machine code.
  bool one_comparison = false;
  /// Without a body: the machine code may consist of the condition alone.
  bool is_empty = false;
  std::optional<Expression> bound;
  std::vector<Total> totals;
};

/// The order of loops in the sources. That of their addresses differs from run to run, and with the
/// order of its rows a linear program may have another of several optimal prices.
struct SourceOrder {
  bool operator()(const SourceLoop* a, const SourceLoop* b) const {
    return a->file == b->file ? a < b : a->file < b->file;  // those of a file are in one array
  }
};

/// A statement with a limit: `at most:`.
struct SourceFact {
  std::string file;
  std::uint32_t line = 0;
  std::uint32_t last = 0;  ///< of the statement, which a formatter may have wrapped
  Total total;
};

/// Maximum value of an argument in the calls of a statement: `with:`.
struct SourceArgument {
  std::string file;
  std::uint32_t line = 0;
  std::string name;
  Expression at_most;
};

struct SourceFile {
  /// `memory: RAM`: all data of its code is in RAM, except literal pools.
  bool in_ram = false;
  std::set<std::uint32_t> in_flash;  ///< `memory: flash`: except on these lines
  std::vector<SourceLoop> loops;
  std::vector<SourceArgument> arguments;
  std::vector<SourceFact> facts;
  std::map<std::string, Expression> constants;  ///< constexpr integers by name
};

/// Throws BoundError on an annotation it cannot read.
[[nodiscard]] SourceFile read_source(const std::string& name, const std::string& text);

/// Sources below several folders, each read when first named.
class SourceCode {
 public:
  /// Throws BoundError if one of them is not a folder.
  explicit SourceCode(const std::vector<std::filesystem::path>& roots);

  /// Converts a name in the debug information to a name relative to its root, which begins with the
  /// name of the root unless that is the first one; empty if the file is in none of them. Throws
  /// BoundError if a relative name may mean a file of two roots.
  [[nodiscard]] std::string name_of(const std::string& compiled_name);
  /// Returns nullptr for a file that is in none of the roots.
  [[nodiscard]] const SourceFile* find(const std::string& name) const;
  [[nodiscard]] const std::map<std::string, SourceFile>& files() const { return files_; }
  /// Value of a constexpr integer of `file`, or else of any file. Throws BoundError if files
  /// differ.
  [[nodiscard]] std::optional<std::int64_t> constant(const std::string& file,
                                                     const std::string& name) const;

 private:
  struct Root {
    std::filesystem::path folder;
    std::filesystem::path label;  ///< before the names of its files
  };
  struct Found {
    const Root* root = nullptr;
    std::filesystem::path file;  ///< relative to the root
  };
  [[nodiscard]] Found find_absolute(const std::filesystem::path& path) const;
  [[nodiscard]] Found find_relative(const std::filesystem::path& path) const;
  [[nodiscard]] std::optional<std::int64_t> constant_in(const std::string& file,
                                                        const std::string& name) const;

  std::vector<Root> roots_;
  std::map<std::string, std::string> names_;
  std::map<std::string, SourceFile> files_;
};

}  // namespace tactree::wcet
