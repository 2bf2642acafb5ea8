#pragma once
// What the sources say beside their code:
//   for (...) {  // bound: EXPRESSION [, total TOTAL]
//   // total: TOTAL      alone above a loop that is bound: one more
//   call(...);   // at most: TOTAL
//   call(...);   // with: ARGUMENT <= EXPRESSION
// where TOTAL is EXPRESSION per FUNCTION [together NAME [as WEIGHT]].
// A remark may follow in parentheses, or after a semicolon.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tactree/bound/expression.hpp"

namespace tactree::bound {

/// So often in one call of the function, at most.
struct Total {
  Expression at_most;
  std::string function;      ///< qualified, without the outermost namespaces: Proxy::update
  std::string together;      ///< what has the same name here is counted together; empty: alone
  std::uint32_t weight = 1;  ///< as so many
};

struct SourceLoop {
  std::string file;
  std::uint32_t line = 0;  ///< where its head begins
  std::uint32_t last = 0;  ///< where its body ends
  std::vector<std::uint32_t> head;
  bool tests_last = false;  ///< do {} while ()
  /// The condition is one comparison: it is evaluated by one branch.
  bool simple = false;
  std::optional<Expression> bound;
  std::vector<Total> totals;
};

/// A statement that one call of a function executes so often at most.
struct SourceFact {
  std::string file;
  std::uint32_t line = 0;
  Total total;
};

/// The largest argument that the calls of one statement give.
struct SourceArgument {
  std::string file;
  std::uint32_t line = 0;
  std::string name;
  Expression at_most;
};

struct SourceFile {
  /// All that its code loads and stores is in RAM, but for constants beside the code.
  bool in_ram = false;
  std::set<std::uint32_t> in_flash;  ///< but for these lines
  std::vector<SourceLoop> loops;
  std::vector<SourceArgument> arguments;
  std::vector<SourceFact> facts;
  std::map<std::string, Expression> constants;  ///< constexpr integers by name
};

/// Reads one file's text; throws BoundError on a bound it cannot read.
[[nodiscard]] SourceFile read_source(const std::string& name, const std::string& text);

/// The sources below one folder, read as they are asked for.
class SourceCode {
 public:
  explicit SourceCode(std::filesystem::path root);

  /// The name below the root of a file as the compiler calls it; empty: it is none of ours.
  [[nodiscard]] std::string name_of(const std::string& compiled_name);
  /// nullptr: not one of ours.
  [[nodiscard]] const SourceFile* find(const std::string& name) const;
  [[nodiscard]] const std::map<std::string, SourceFile>& files() const { return files_; }
  /// A constexpr integer: of `file`, or else of any file when all agree.
  [[nodiscard]] std::optional<std::int64_t> constant(const std::string& file,
                                                     const std::string& name) const;

 private:
  [[nodiscard]] std::optional<std::int64_t> constant_in(const std::string& file,
                                                        const std::string& name) const;

  std::filesystem::path root_;
  std::map<std::string, std::string> names_;
  std::map<std::string, SourceFile> files_;
};

}  // namespace tactree::bound
