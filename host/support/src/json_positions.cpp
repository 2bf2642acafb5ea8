#include "json_positions.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace tactree::support {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kJsonBlanks = " \t\r\n";

/// Offset behind the string that begins with the quote at `at`.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  ++at;
  while (at < text.size() && text[at] != '"') {
    at += text[at] == '\\' ? 2U : 1U;
  }
  return std::min(at + 1U, text.size());
}

std::size_t end_of_literal(std::string_view text, std::size_t at) {
  return std::min(text.find_first_of(" \t\r\n,]}", at), text.size());
}

/// Accepts everything and keeps the first error.
class ErrorFinder : public nlohmann::json_sax<nlohmann::json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(std::size_t) override { return true; }
  bool key(string_t&) override { return true; }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool parse_error(std::size_t end, const std::string&,
                   const nlohmann::detail::exception& error) override {
    found_ = {end == 0 ? 0U : end - 1U, cause_of(error.what())};
    return false;
  }

  [[nodiscard]] const std::optional<JsonError>& found() const { return found_; }

 private:
  /// Without the name of the exception and the position.
  static std::string cause_of(const std::string& message) {
    const std::size_t column = message.find(", column ");
    const std::size_t begin =
        column == std::string::npos ? message.find("] ") : message.find(": ", column);
    return begin == std::string::npos ? message : message.substr(begin + 2U);
  }

  std::optional<JsonError> found_;
};

}  // namespace

std::optional<JsonError> find_json_error(std::string_view text) {
  ErrorFinder finder;
  nlohmann::json::sax_parse(text, &finder);
  return finder.found();
}

TextPosition position_of(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, offset);
  const std::size_t line_begin = before.rfind('\n') + 1U;  // npos + 1 is 0
  TextPosition position;
  position.line += static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  for (const char c : before.substr(line_begin)) {
    position.column += (static_cast<unsigned char>(c) & 0xC0U) == 0x80U ? 0U : 1U;
  }
  return position;
}

/// Reads the text once. Objects and lists within the members of the outermost object are skipped.
class JsonPositions::Scan {
 public:
  Scan(std::string_view text, JsonPositions& found) : text_(text), found_(found) {}

  void run() {
    at_ = text_.substr(0, kByteOrderMark.size()) == kByteOrderMark ? kByteOrderMark.size() : 0U;
    while (skip_blanks()) {
      const char c = text_[at_];
      if (c == '}' || c == ']') {
        --depth_;
        ++at_;
      } else if (c == ',' || c == ':') {
        separate(c);
      } else if (key_is_next_) {
        take_key();
      } else {
        take_value(c);
      }
    }
  }

 private:
  bool skip_blanks() {
    at_ = std::min(text_.find_first_not_of(kJsonBlanks, at_), text_.size());
    return at_ < text_.size();
  }

  void separate(char c) {
    if (c == ',') {
      key_is_next_ = depth_ == 1;
      item_ += depth_ == 2 ? 1U : 0U;
    }
    ++at_;
  }

  void take_key() {
    const std::size_t end = end_of_string(text_, at_);
    key_ = nlohmann::json::parse(text_.substr(at_, end - at_)).get<std::string>();
    const auto [known, is_new] = found_.keys_.try_emplace(key_, at_);
    if (!is_new) {
      found_.repetitions_.push_back({key_, at_, known->second});
    }
    key_is_next_ = false;
    at_ = end;
  }

  void take_value(char c) {
    if (depth_ == 0) {
      found_.root_ = at_;
    } else if (depth_ == 1) {
      found_.values_[key_] = at_;
      item_ = 0;
      in_list_ = c == '[';
    } else if (depth_ == 2 && in_list_) {
      found_.values_[fmt::format("{}[{}]", key_, item_)] = at_;
    }
    if (c == '{' || c == '[') {
      key_is_next_ = depth_ == 0 && c == '{';
      ++depth_;
      ++at_;
    } else {
      at_ = c == '"' ? end_of_string(text_, at_) : end_of_literal(text_, at_);
    }
  }

  std::string_view text_;
  JsonPositions& found_;
  std::size_t at_ = 0;
  std::size_t depth_ = 0;     // number of open objects and lists
  bool key_is_next_ = false;  // of the outermost object
  bool in_list_ = false;      // the member `key_` is a list
  std::size_t item_ = 0;      // of that list
  std::string key_;
};

JsonPositions::JsonPositions(std::string_view text) { Scan(text, *this).run(); }

std::size_t JsonPositions::key(const std::string& key) const {
  const auto found = keys_.find(key);
  return found == keys_.end() ? root_ : found->second;
}

std::size_t JsonPositions::value(const std::string& path) const {
  const auto found = values_.find(path);
  return found == values_.end() ? root_ : found->second;
}

}  // namespace tactree::support
