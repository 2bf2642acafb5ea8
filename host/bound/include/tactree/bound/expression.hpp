#pragma once
// The bounds written beside the loops: integers and names, + - * / %, min(a, b), max(a, b).

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace tactree::bound {

/// What a name stands for; nothing: unknown.
using Names = std::function<std::optional<std::int64_t>(const std::string&)>;

class Expression {
 public:
  /// Reads as much of `text` as is an expression and removes it from there; what follows is for
  /// people. Throws BoundError on anything else; `where` is for its text.
  [[nodiscard]] static Expression read(std::string_view& text, const std::string& where);

  /// Throws BoundError on a name that nobody knows and on a division by zero.
  [[nodiscard]] std::int64_t value(const Names& names) const;
  [[nodiscard]] bool mentions(std::string_view name) const;
  /// As it was written.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  struct Node;
  friend class ExpressionReader;

  std::shared_ptr<const Node> root_;
  std::string text_;
  std::string where_;
};

}  // namespace tactree::bound
