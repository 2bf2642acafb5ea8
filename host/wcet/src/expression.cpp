#include "tactree/wcet/expression.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {

struct Expression::Node {
  char operation = 0;  // '#' number, 'n' name, '+', '-', '*', '/', '%', '<' min, '>' max
  std::int64_t number = 0;
  std::string name;
  std::shared_ptr<const Node> left;
  std::shared_ptr<const Node> right;

  [[nodiscard]] std::int64_t value(const Names& names, const std::string& where) const {
    if (operation == '#') {
      return number;
    }
    if (operation == 'n') {
      const std::optional<std::int64_t> known = names(name);
      if (!known) {
        throw BoundError(
            fmt::format("{}: '{}' is unknown (use a constant of the source, a limit of "
                        "the model, or an argument)",
                        where, name));
      }
      return *known;
    }
    return combined(left->value(names, where), right->value(names, where), where);
  }

  [[nodiscard]] std::int64_t combined(std::int64_t a, std::int64_t b,
                                      const std::string& where) const {
    if (b == 0 && (operation == '/' || operation == '%')) {
      throw BoundError(where + ": the bound divides by zero (correct the expression)");
    }
    switch (operation) {
      case '+':
        return a + b;
      case '-':
        return a - b;
      case '*':
        return a * b;
      case '/':
        return a / b;
      case '%':
        return a % b;
      case '<':
        return std::min(a, b);
      default:
        return std::max(a, b);
    }
  }

  [[nodiscard]] bool mentions(std::string_view wanted) const {
    return name == wanted || (left && left->mentions(wanted)) || (right && right->mentions(wanted));
  }
};

/// Recursive descent; the text is one line of a source file.
class ExpressionReader {
 public:
  using Node = Expression::Node;
  using NodePointer = std::shared_ptr<const Node>;

  ExpressionReader(std::string_view& text, std::string where)
      : text_(text), where_(std::move(where)) {}

  Expression read() {
    const std::string_view all = text_;
    Expression result;
    result.root_ = sum();
    std::string_view read = all.substr(0, all.size() - text_.size());
    while (!read.empty() && read.front() == ' ') {
      read.remove_prefix(1);
    }
    result.text_ = read;
    result.where_ = where_;
    return result;
  }

 private:
  static NodePointer make(char operation, NodePointer left, NodePointer right) {
    return std::make_shared<Node>(Node{operation, 0, {}, std::move(left), std::move(right)});
  }

  /// Next character other than a space; 0 at the end of the text.
  [[nodiscard]] char peek() const {
    const std::size_t at = text_.find_first_not_of(' ');
    return at == std::string_view::npos ? '\0' : text_[at];
  }

  void take() { text_.remove_prefix(text_.find_first_not_of(' ') + 1); }

  NodePointer sum() {
    NodePointer left = product();
    while (peek() == '+' || peek() == '-') {
      const char operation = peek();
      take();
      left = make(operation, left, product());
    }
    return left;
  }

  NodePointer product() {
    NodePointer left = atom();
    while (peek() == '*' || peek() == '/' || peek() == '%') {
      const char operation = peek();
      take();
      left = make(operation, left, atom());
    }
    return left;
  }

  NodePointer atom() {
    const char first = peek();
    if (first == '(') {
      take();
      NodePointer inner = sum();
      expect(')');
      return inner;
    }
    if (std::isdigit(static_cast<unsigned char>(first)) != 0) {
      return std::make_shared<Node>(Node{'#', std::stoll(word()), {}, nullptr, nullptr});
    }
    if (std::isalpha(static_cast<unsigned char>(first)) == 0) {
      refuse();
    }
    const std::string name = word();
    if ((name == "min" || name == "max") && peek() == '(') {
      take();
      NodePointer left = sum();
      expect(',');
      NodePointer right = sum();
      expect(')');
      return make(name == "min" ? '<' : '>', left, right);
    }
    return std::make_shared<Node>(Node{'n', 0, name, nullptr, nullptr});
  }

  std::string word() {
    text_.remove_prefix(text_.find_first_not_of(' '));
    std::size_t length = 0;
    while (length < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[length])) != 0 || text_[length] == '_')) {
      ++length;
    }
    std::string result(text_.substr(0, length));
    text_.remove_prefix(length);
    return result;
  }

  void expect(char wanted) {
    if (peek() != wanted) {
      refuse();
    }
    take();
  }

  [[noreturn]] void refuse() const {
    throw BoundError(fmt::format(
        "{}: no expression begins at '{}' (write numbers, names, + - * / %, min(), max())", where_,
        text_));
  }

  std::string_view& text_;
  std::string where_;
};

Expression Expression::read(std::string_view& text, const std::string& where) {
  return ExpressionReader(text, where).read();
}

std::int64_t Expression::value(const Names& names) const { return root_->value(names, where_); }

bool Expression::mentions(std::string_view name) const { return root_->mentions(name); }

}  // namespace tactree::wcet
