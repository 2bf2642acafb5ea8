#pragma once
// Expressions of annotations: integers, names, + - * / %, parentheses, min(a, b), max(a, b).
// Division rounds towards zero.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tactree::wcet {

/// Returns the value of a name; nullopt if it is unknown.
using Names = std::function<std::optional<std::int64_t>(const std::string&)>;

class Expression {
 public:
  /// Removes the expression at the beginning of `text` and returns it. Throws BoundError if there
  /// is none; `where` is the location in messages.
  [[nodiscard]] static Expression read(std::string_view& text, const std::string& where);

  /// Throws BoundError on an unknown name and on a division by zero.
  [[nodiscard]] std::int64_t value(const Names& names) const;
  [[nodiscard]] bool mentions(std::string_view name) const;
  /// As written in the source.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  struct Node;
  friend class ExpressionReader;

  std::shared_ptr<const Node> root_;
  std::string text_;
  std::string where_;
};

}  // namespace tactree::wcet
