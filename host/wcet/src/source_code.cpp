#include "source_code.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string_view>

#include "tactree/wcet/bound_error.hpp"

namespace tactree::wcet {
namespace {

/// True if a string or character begins here. A ' after a digit is a digit separator.
bool is_quote(const std::string& text, std::size_t i) {
  return text[i] == '"' ||
         (text[i] == '\'' &&
          (i == 0 || std::isxdigit(static_cast<unsigned char>(text[i - 1])) == 0));
}

/// The code with comments, strings and characters replaced by spaces.
std::string blanked(const std::string& text) {
  std::string code = text;
  const auto blank = [&code](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, code.size()); ++i) {
      code[i] = code[i] == '\n' ? '\n' : ' ';
    }
    return to;
  };
  std::size_t i = 0;
  while (i < text.size()) {
    if (text.compare(i, 2, "//") == 0) {
      i = blank(i, text.find('\n', i));
    } else if (text.compare(i, 2, "/*") == 0) {
      const std::size_t end = text.find("*/", i);
      i = blank(i, end == std::string::npos ? end : end + 2);
    } else if (is_quote(text, i)) {
      std::size_t end = i + 1;
      while (end < text.size() && text[end] != text[i] && text[end] != '\n') {
        end += text[end] == '\\' ? 2U : 1U;
      }
      i = blank(i, end + 1);
    } else {
      ++i;
    }
    if (i == std::string::npos) {
      break;
    }
  }
  return code;
}

class Reader {
 public:
  Reader(const std::string& name, const std::string& text) : name_(name), code_(blanked(text)) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
      lines_.push_back(line);
    }
    for (std::size_t i = 0; i < code_.size(); ++i) {
      if (code_[i] == '\n') {
        ends_.push_back(i);
      }
    }
  }

  SourceFile read() {
    read_loops();
    read_facts();
    read_constants();
    return std::move(file_);
  }

 private:
  [[nodiscard]] std::uint32_t line_of(std::size_t offset) const {
    const auto found = std::lower_bound(ends_.begin(), ends_.end(), offset);
    return static_cast<std::uint32_t>(found - ends_.begin()) + 1U;
  }

  [[nodiscard]] std::string place(std::uint32_t line) const {
    return fmt::format("{}:{}", name_, line);
  }

  /// Offset of the bracket that closes the first `open` at or after `from`.
  [[nodiscard]] std::size_t closing(std::size_t from, char open, char close) const {
    int depth = 0;
    for (std::size_t i = code_.find(open, from); i < code_.size(); ++i) {
      depth += code_[i] == open ? 1 : 0;
      depth -= code_[i] == close ? 1 : 0;
      if (depth == 0) {
        return i;
      }
    }
    throw BoundError(place(line_of(from)) + ": a bracket is not closed (close it)");
  }

  [[nodiscard]] std::size_t next_word(std::size_t from) const {
    return code_.find_first_not_of(" \n", from);
  }

  /// End of the statement that begins after `from`.
  [[nodiscard]] std::size_t statement_end(std::size_t from) const {
    const std::size_t begin = next_word(from);
    if (begin != std::string::npos && code_[begin] == '{') {
      return closing(begin, '{', '}');
    }
    // A loop or branch without braces ends with its own statement, which may be a nested block.
    const std::size_t end = code_.find(';', from);
    const std::size_t brace = code_.find('{', from);
    return brace < end ? closing(brace, '{', '}') : end;
  }

  void read_loops() {
    static const std::regex kLoop(R"(\b(for|while|do)\b)");
    for (std::sregex_iterator it(code_.begin(), code_.end(), kLoop), end; it != end; ++it) {
      const auto begin = static_cast<std::size_t>(it->position());
      if (it->str() == "do") {
        add_do_loop(begin);
      } else if (!is_end_of_do(begin)) {
        add_loop(begin, it->str() == "for");
      }
    }
  }

  [[nodiscard]] bool is_end_of_do(std::size_t begin) const {
    return std::find(do_ends_.begin(), do_ends_.end(), begin) != do_ends_.end();
  }

  void add_do_loop(std::size_t begin) {
    const std::size_t body_end = statement_end(begin + 2);
    const std::size_t again = next_word(body_end + 1);
    do_ends_.push_back(again);
    const std::size_t end = closing(again, '(', ')');
    SourceLoop loop = loop_at(begin, end);
    loop.tests_last = true;
    for (std::uint32_t line = line_of(again); line <= line_of(end); ++line) {
      loop.head.push_back(line);
    }
    read_bound(loop, {loop.line, loop.line - 1});
    file_.loops.push_back(std::move(loop));
  }

  void add_loop(std::size_t begin, bool is_for) {
    const std::size_t head_end = closing(begin, '(', ')');
    const std::size_t body_end = statement_end(head_end + 1);
    SourceLoop loop = loop_at(begin, body_end);
    for (std::uint32_t line = loop.line; line <= line_of(head_end); ++line) {
      loop.head.push_back(line);
    }
    loop.one_comparison = is_one_comparison(code_.substr(begin, head_end - begin), is_for);
    loop.is_empty = code_.substr(head_end + 1, body_end - head_end).find_first_not_of(" \n{};") ==
                    std::string::npos;
    read_bound(loop, {loop.line, line_of(head_end), loop.line - 1});
    file_.loops.push_back(std::move(loop));
  }

  [[nodiscard]] SourceLoop loop_at(std::size_t begin, std::size_t end) const {
    SourceLoop loop;
    loop.file = name_;
    loop.line = line_of(begin);
    loop.last = line_of(end);
    return loop;
  }

  /// True for `for (x : y)` and for a condition without &&, || and ?:.
  static bool is_one_comparison(const std::string& head, bool is_for) {
    std::string condition = head.substr(head.find('(') + 1);
    if (is_for && condition.find(';') != std::string::npos) {
      condition = condition.substr(condition.find(';') + 1);
      condition = condition.substr(0, condition.find(';'));
    }
    return condition.find("&&") == std::string::npos && condition.find("||") == std::string::npos &&
           condition.find('?') == std::string::npos;
  }

  /// Text after `word` in the comment of a line; empty if the comment does not contain it.
  [[nodiscard]] std::string_view annotation(std::uint32_t line, const std::string& word) const {
    if (line == 0 || line > lines_.size()) {
      return {};
    }
    const std::string& text = lines_[line - 1];
    const std::size_t comment = text.find("//");
    const std::size_t at = comment == std::string::npos ? comment : text.find(word, comment);
    return at == std::string::npos ? std::string_view{}
                                   : std::string_view(text).substr(at + word.size());
  }

  /// True if the line is a comment only, which refers to the next line of code.
  [[nodiscard]] bool stands_alone(std::uint32_t line) const {
    const std::string& text = lines_[line - 1];
    const std::size_t begin = text.find_first_not_of(' ');
    return begin != std::string::npos && text.compare(begin, 2, "//") == 0;
  }

  void read_bound(SourceLoop& loop, const std::vector<std::uint32_t>& places) const {
    for (const std::uint32_t line : places) {
      std::string_view text = annotation(line, "bound:");
      const bool is_before_the_head = line + 1 == loop.line;
      if (text.empty() || (is_before_the_head && !stands_alone(line))) {
        continue;
      }
      loop.bound = Expression::read(text, place(line));
      static constexpr std::string_view kTotal = ", total ";
      if (text.starts_with(kTotal)) {
        text.remove_prefix(kTotal.size());
        loop.totals.push_back(read_total(text, line));
      }
      check_remark(text, line);
      read_totals_above(loop);
      return;
    }
  }

  void read_totals_above(SourceLoop& loop) const {
    for (std::uint32_t line = loop.line - 1; line > 0 && stands_alone(line); --line) {
      std::string_view text = annotation(line, "total:");
      if (!text.empty()) {
        loop.totals.push_back(read_total(text, line));
        check_remark(text, line);
      }
    }
  }

  [[nodiscard]] Total read_total(std::string_view& text, std::uint32_t line) const {
    Total total{Expression::read(text, place(line)), {}, {}, 1};
    static constexpr std::string_view kPer = " per ";
    if (!text.starts_with(kPer)) {
      throw BoundError(place(line) +
                       ": 'per FUNCTION' is missing (name the function in whose calls it counts)");
    }
    text.remove_prefix(kPer.size());
    const std::size_t end = std::min(text.find_first_of(" ,;("), text.size());
    total.function = text.substr(0, end);
    text.remove_prefix(end);
    total.together = read_word(text, " together ");
    const std::string weight = read_word(text, " as ");
    if (!weight.empty()) {
      const auto end_of_number = weight.data() + weight.size();
      if (std::from_chars(weight.data(), end_of_number, total.weight).ptr != end_of_number) {
        throw BoundError(
            fmt::format("{}: '{}' is not a weight (write an integer)", place(line), weight));
      }
    }
    return total;
  }

  /// Removes `before` and the word after it, and returns the word; empty if `text` does not begin
  /// with `before`.
  static std::string read_word(std::string_view& text, std::string_view before) {
    if (!text.starts_with(before)) {
      return {};
    }
    text.remove_prefix(before.size());
    const std::string_view word = text.substr(0, text.find_first_of(" ,;("));
    text.remove_prefix(word.size());
    return std::string(word);
  }

  // "2 nodes" must not be read as 2.
  void check_remark(std::string_view text, std::uint32_t line) const {
    const std::size_t at = text.find_first_not_of(' ');
    if (at != std::string_view::npos && text[at] != '(' && text[at] != ';') {
      throw BoundError(
          fmt::format("{}: '{}' is not part of the annotation (put remarks in parentheses)",
                      place(line), text));
    }
  }

  [[nodiscard]] SourceArgument read_argument(std::string_view text, std::uint32_t line) const {
    const std::size_t sign = text.find("<=");
    const std::size_t begin = text.find_first_not_of(' ');
    if (sign == std::string_view::npos || begin >= sign) {
      throw BoundError(place(line) + ": the argument cannot be read (write `with: NAME <= BOUND`)");
    }
    const std::string_view name = text.substr(begin, sign - begin);
    text.remove_prefix(sign + 2);
    SourceArgument argument{name_, line + (stands_alone(line) ? 1U : 0U),
                            std::string(name.substr(0, name.find(' '))),
                            Expression::read(text, place(line))};
    check_remark(text, line);
    return argument;
  }

  void read_facts() {
    for (std::uint32_t line = 1; line <= lines_.size(); ++line) {
      file_.in_ram = file_.in_ram || lines_[line - 1] == "// memory: RAM";
      if (annotation(line, "memory: flash").data() != nullptr) {
        add_flash(line);
      }
      std::string_view text = annotation(line, "at most:");
      if (!text.empty()) {
        SourceFact fact{name_, line, 0, read_total(text, line)};
        while (fact.line < lines_.size() && stands_alone(fact.line)) {
          ++fact.line;
        }
        check_remark(text, line);
        fact.last = end_of_statement(fact.line);
        if (fact.last == 0) {
          throw BoundError(
              place(line) +
              ": 'at most:' belongs to no statement (write it above one, or beside it)");
        }
        file_.facts.push_back(std::move(fact));
      }
      text = annotation(line, "with:");
      if (!text.empty()) {
        file_.arguments.push_back(read_argument(text, line));
      }
    }
  }

  /// Last line of the statement or head that begins on `line`; 0 if no code begins there.
  [[nodiscard]] std::uint32_t end_of_statement(std::uint32_t line) const {
    const auto code_of = [&](std::uint32_t at) {
      const std::string& text = lines_[at - 1];
      return text.substr(0, text.find("//"));
    };
    if (code_of(line).find_first_not_of(' ') == std::string::npos) {
      return 0;
    }
    while (line < lines_.size() && code_of(line).find_first_of(";{}") == std::string::npos) {
      ++line;
    }
    return line;
  }

  /// Adds the line or, for a comment on a separate line, the next statement.
  void add_flash(std::uint32_t line) {
    const bool is_whole = stands_alone(line);
    line += is_whole ? 1U : 0U;
    file_.in_flash.insert(line);
    while (is_whole && line < lines_.size() && lines_[line - 1].find(';') == std::string::npos) {
      file_.in_flash.insert(++line);
    }
  }

  void read_constants() {
    static const std::regex kConstant(
        R"(constexpr\s+(?:std::)?u?(?:int(?:8|16|32|64)_t|int|nsigned|size_t)\s+(k\w+)\s*=([^;{]*);)");
    for (std::sregex_iterator it(code_.begin(), code_.end(), kConstant), end; it != end; ++it) {
      const std::string value =
          std::regex_replace(it->str(2), std::regex(R"((\d)[uUlL]+\b|\n)"), "$1");
      std::string_view text = value;
      try {
        Expression expression =
            Expression::read(text, place(line_of(static_cast<std::size_t>(it->position()))));
        if (text.find_first_not_of(' ') == std::string_view::npos) {
          file_.constants.emplace(it->str(1), std::move(expression));
        }
      } catch (const BoundError&) {
        continue;  // not an integer: annotations cannot name it
      }
    }
  }

  std::string name_;
  std::string code_;
  std::vector<std::string> lines_;
  std::vector<std::size_t> ends_;
  std::vector<std::size_t> do_ends_;
  SourceFile file_;
};

}  // namespace

SourceFile read_source(const std::string& name, const std::string& text) {
  return Reader(name, text).read();
}

namespace {

namespace fs = std::filesystem;

/// The path without its first part.
fs::path shortened(const fs::path& path) {
  const fs::path rest = path.lexically_relative(*path.begin());
  return rest == "." ? fs::path() : rest;
}

}  // namespace

SourceCode::SourceCode(const std::vector<fs::path>& roots) {
  for (const fs::path& given : roots) {
    fs::path folder = fs::absolute(given).lexically_normal();
    folder = folder.has_filename() ? folder : folder.parent_path();
    if (!fs::is_directory(folder)) {
      throw BoundError(
          fmt::format("{}: is not a folder (name a folder of the sources)", given.string()));
    }
    const bool is_new = std::none_of(roots_.begin(), roots_.end(),
                                     [&](const Root& root) { return root.folder == folder; });
    const bool is_named = std::any_of(roots_.begin(), roots_.end(), [&](const Root& root) {
      return root.label == folder.filename();
    });
    if (is_new) {
      const fs::path label = is_named ? folder : folder.filename();
      roots_.push_back({folder, roots_.empty() ? fs::path() : label});
    }
  }
}

// A name that the compiler wrote relative to a folder of the build below the root has further parts
// before that of the file.
SourceCode::Found SourceCode::find_absolute(const fs::path& path) const {
  for (const Root& root : roots_) {
    fs::path file = path.lexically_relative(root.folder);
    if (file.empty() || *file.begin() == "..") {
      continue;
    }
    while (!file.empty() && !fs::is_regular_file(root.folder / file)) {
      file = shortened(file);
    }
    if (!file.empty()) {
      return {&root, file};
    }
  }
  return {};
}

SourceCode::Found SourceCode::find_relative(const fs::path& path) const {
  for (fs::path file = path; !file.empty(); file = shortened(file)) {
    Found found;
    for (const Root& root : roots_) {
      if (!fs::is_regular_file(root.folder / file)) {
        continue;
      }
      if (found.root != nullptr) {
        throw BoundError(
            fmt::format("{}: is in {} and in {} (compile your sources with their absolute paths)",
                        file.string(), found.root->folder.string(), root.folder.string()));
      }
      found = {&root, file};
    }
    if (found.root != nullptr) {
      return found;
    }
  }
  return {};
}

std::string SourceCode::name_of(const std::string& compiled_name) {
  const auto known = names_.find(compiled_name);
  if (known != names_.end()) {
    return known->second;
  }
  const fs::path path = fs::path(compiled_name).lexically_normal();
  const Found found = path.is_absolute() ? find_absolute(path) : find_relative(path);
  std::string& name = names_[compiled_name];
  if (found.root == nullptr) {
    return name;
  }
  name = (found.root->label / found.file).generic_string();
  if (!files_.contains(name)) {
    std::ifstream stream(found.root->folder / found.file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    files_.emplace(name, read_source(name, text));
  }
  return name;
}

const SourceFile* SourceCode::find(const std::string& name) const {
  const auto found = files_.find(name);
  return found == files_.end() ? nullptr : &found->second;
}

std::optional<std::int64_t> SourceCode::constant_in(const std::string& file,
                                                    const std::string& name) const {
  const SourceFile* source = find(file);
  if (source == nullptr || !source->constants.contains(name)) {
    return std::nullopt;
  }
  return source->constants.at(name).value(
      [&](const std::string& inner) { return constant(file, inner); });
}

std::optional<std::int64_t> SourceCode::constant(const std::string& file,
                                                 const std::string& name) const {
  if (const auto own = constant_in(file, name)) {
    return own;
  }
  std::optional<std::int64_t> result;
  for (const auto& [other, source] : files_) {
    const auto value = constant_in(other, name);
    if (value && result && *value != *result) {
      throw BoundError(
          fmt::format("{}: '{}' is {} in one file and {} in another (rename one of them)", file,
                      name, *value, *result));
    }
    result = value ? value : result;
  }
  return result;
}

}  // namespace tactree::wcet
