#include "text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "number.hpp"
#include "text_columns.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kSampleRows = 1000;
constexpr std::size_t kSampleLines = 4000;  // of the sample, including those before the rows
constexpr std::size_t kMaxColumns = 4096;
constexpr std::size_t kMinTableColumns = 3;
constexpr const char* kNotPoints =
    "a text file of points has rows of numbers, x y z first or under a line of column names; "
    "otherwise name them, as in --columns x=2,y=3,z=4";
constexpr const char* kNameColumns =
    "if they are points, name the columns, as in --columns x=1,y=2,z=3; else save the scan as PLY";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// True for a line such as "1,5 2,5 3,5": every comma is between digits, at most one in a word, and
/// there are three words or more.
bool has_decimal_commas(std::string_view line) {
  std::size_t words = 0;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) {
    ++words;
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos) continue;
    if (word.find(',', comma + 1) != std::string_view::npos) return false;
    if (comma == 0 || comma + 1 >= word.size()) return false;
    if (!is_digit(word[comma - 1]) || !is_digit(word[comma + 1])) return false;
  }
  return words >= kMinTableColumns;
}

void find_separator(std::string_view line, TextLayout& layout) {
  const bool comma = line.find(',') != std::string_view::npos;
  layout.decimal_comma = false;
  layout.separator = ' ';
  if (line.find(';') != std::string_view::npos) {
    layout.separator = ';';
    layout.decimal_comma = comma;
  } else if (comma && has_decimal_commas(line)) {
    layout.decimal_comma = true;
  } else if (comma) {
    layout.separator = ',';
  }
}

/// Returns false if a required field is not a number: a named column, or one of the first three
/// columns without names. Other fields that are not numbers become NaN.
bool parse_row(std::string_view line, const TextLayout& layout, TextRow& row) {
  row = {};
  std::string_view field;
  bool all_numbers = true;
  while (row.values.size() < kMaxColumns && take_field(line, layout.separator, field)) {
    const std::size_t column = row.values.size();
    const bool named = column < layout.slots.size() && layout.slots[column] != kNoSlot;
    const bool needed = layout.slots.empty() ? column < kMinTableColumns : named;
    double value = 0;
    if (!parse_field(field, layout.decimal_comma, value)) {
      if (needed) return false;
      value = std::numeric_limits<double>::quiet_NaN();
      all_numbers = false;
    }
    row.values.push_back(value);
    if (all_numbers) row.numbers = row.values.size();
  }
  return true;
}

std::string_view without_comment_signs(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of("/#%! \t"), text.size()));
  return text;
}

/// Returns the name without its unit: "x [m]" or "//x" -> "x".
std::string_view bare_name(std::string_view field) {
  field = without_comment_signs(field);
  return trim(field.substr(0, field.find_first_of("[(")));
}

bool read_column_names(std::string_view line, TextLayout& layout) {
  line = trim(without_comment_signs(line));
  char separator = ' ';
  if (line.find(',') != std::string_view::npos) separator = ',';
  if (line.find(';') != std::string_view::npos) separator = ';';
  std::vector<std::string_view> names;
  std::string_view field;
  while (names.size() < kMaxColumns && take_field(line, separator, field)) {
    names.push_back(bare_name(field));
  }
  layout.slots = slots_of_names(names);
  return !layout.slots.empty();
}

/// True for a row such as "830 3 0": several whole numbers and nothing else.
bool are_counts(const TextRow& row) {
  return row.values.size() >= 2 && row.numbers == row.values.size() &&
         std::all_of(row.values.begin(), row.values.end(),
                     [](double value) { return value >= 0 && value == std::floor(value); });
}

/// Detects rows such as "1,5,2,25,3,0625", which may be three numbers with decimal commas,
/// separated by commas.
class SplitDecimals {
 public:
  /// `names` is the number of columns that a line names, or 0.
  void look_at(std::string_view row, std::size_t names) {
    std::size_t fields = 0;
    std::string_view field;
    while (take_field(row, ',', field)) {
      const bool fraction = ++fields % 2 == 0;
      const std::string_view digits = field.starts_with('-') ? field.substr(1) : field;
      const bool whole = !digits.empty() && std::all_of(digits.begin(), digits.end(), is_digit);
      possible_ = possible_ && whole && !(fraction && field.starts_with('-'));
      // A field with a leading zero is not a whole number, so it is a fraction.
      seen_ = seen_ || (fraction && field.size() > 1 && field.starts_with('0'));
    }
    possible_ = possible_ && fields % 2 == 0 && fields >= 2 * kMinTableColumns;
    seen_ = seen_ || (names > 0 && fields >= 2 * names);
  }
  [[nodiscard]] bool are_likely() const { return possible_ && seen_; }

 private:
  bool possible_ = true;
  bool seen_ = false;
};

/// Determines the layout from the first lines.
class LayoutFinder {
 public:
  LayoutFinder(InputFile& file, const ColumnMap& columns) : file_(file) {
    layout_.slots = slots_of_columns(columns);
    if (!columns.empty()) layout_.source = "as named";
  }

  TextLayout find() {
    file_.rewind();
    std::string_view line;
    std::size_t lines = 0;
    while (rows_.size() < kSampleRows && lines < kSampleLines && file_.next_line(line)) {
      look_at(line);
      if (!text_of_line(line).empty()) ++lines;
    }
    if (rows_.empty()) refuse();
    refuse_split_decimals();
    layout_.row_bytes = static_cast<double>(row_bytes_) / static_cast<double>(rows_.size());
    settle_columns();
    leave_out_unused(layout_.slots);
    file_.rewind();
    return std::move(layout_);
  }

 private:
  void look_at(std::string_view line) {
    const std::string_view text = text_of_line(line);
    if (text.empty()) {
      // CloudCompare writes the column names after "//", others after '%' or '!'.
      if (rows_.empty() && layout_.slots.empty()) (void)take_names(trim(line));
      return;
    }
    if (rows_.empty()) find_separator(text, layout_);
    TextRow row;
    const bool numbers = parse_row(text, layout_, row);
    if (numbers && rows_.empty() && is_count(row)) {
      layout_.declared = static_cast<std::uint64_t>(row.values[0]);
      return;
    }
    const bool unnamed = rows_.empty() && layout_.slots.empty();
    // The '#' of "Point#, X, Y, Z" does not begin a comment.
    if (!numbers && unnamed && (take_names(text) || take_names(trim(line)))) return;
    if (numbers && row.values.size() >= std::max(kMinTableColumns, layout_.slots.size())) {
      if (layout_.separator == ',') split_.look_at(text, layout_.slots.size());
      if (rows_.empty()) layout_.first_row_line = file_.line_number();
      row_bytes_ += line.size() + 1;
      rows_.push_back(std::move(row));
      return;
    }
    if (numbers && unnamed && are_counts(row) && counts_line_ == 0) {
      counts_line_ = file_.line_number();
      counts_text_ = printable(text);
    }
    note_other(text, numbers);
  }

  [[nodiscard]] bool is_count(const TextRow& row) const {
    // A title may contain other counts.
    return !layout_.declared && first_other_line_ == 0 && row.values.size() == 1 &&
           row.numbers == 1 && row.values[0] >= 0 && row.values[0] == std::floor(row.values[0]) &&
           row.values[0] < 1e15;
  }

  bool take_names(std::string_view text) {
    if (!read_column_names(text, layout_)) return false;
    layout_.header_line = file_.line_number();
    layout_.source = fmt::format("named by line {}", layout_.header_line);
    leave_out_unused(layout_.slots);
    return true;
  }

  void note_other(std::string_view text, bool numbers) {
    if (first_other_line_ != 0) return;
    first_other_line_ = file_.line_number();
    first_other_text_ = printable(text);
    std::string_view field;
    other_fields_ = 0;
    const char separator = text.find(',') != text.npos ? ',' : layout_.separator;
    while (take_field(text, separator, field)) ++other_fields_;
    other_is_numbers_ = numbers;
  }

  /// Throws ReadError, because there is no row of numbers.
  [[noreturn]] void refuse() const {
    if (first_other_line_ == 0) {
      throw ReadError(file_.name(), "", "the text contains no points, only comments or blank lines",
                      "check the export, and export it again");
    }
    const std::string place = fmt::format("line {}", first_other_line_);
    if (other_is_numbers_ && !layout_.slots.empty()) {
      const bool by_user = layout_.header_line == 0;
      throw ReadError(file_.name(), place,
                      fmt::format("the row has {} values, but {} {} columns", other_fields_,
                                  by_user ? "--columns names"
                                          : fmt::format("line {} names", layout_.header_line),
                                  layout_.slots.size()),
                      by_user ? "check --columns" : "export the scan again");
    }
    if (other_is_numbers_) {
      throw ReadError(file_.name(), place,
                      fmt::format("\"{}\" has fewer than three numbers", first_other_text_),
                      kNotPoints);
    }
    throw ReadError(
        file_.name(), place,
        fmt::format("the file is text, but not a list of points: \"{}\"", first_other_text_),
        kNotPoints);
  }

  void refuse_split_decimals() const {
    if (layout_.separator != ',' || !split_.are_likely()) return;
    throw ReadError(file_.name(), fmt::format("line {}", layout_.first_row_line),
                    "its commas seem to be decimal commas as well as the separators of its columns",
                    "export it with decimal points, or with semicolons between the columns");
  }

  void settle_columns() {
    if (!layout_.slots.empty()) return;
    const std::size_t columns = rows_.front().values.size();
    const bool unnamed_header = first_other_line_ != 0 && !other_is_numbers_ &&
                                first_other_line_ < layout_.first_row_line &&
                                other_fields_ == columns;
    if (unnamed_header) {
      throw ReadError(
          file_.name(), fmt::format("line {}", first_other_line_),
          fmt::format("the column names \"{}\" do not include x, y and z", first_other_text_),
          "rename these columns to x, y and z, or give their numbers, as in "
          "--columns x=2,y=3,z=4");
    }
    ColumnGuess guess = guess_columns(rows_, layout_.declared.has_value());
    if (counts_line_ != 0 && counts_line_ < layout_.first_row_line) {
      refuse_guess(counts_line_,
                   fmt::format("\"{}\" looks like the counts of a mesh or a grid", counts_text_));
    }
    if (!guess.doubt.empty()) refuse_guess(layout_.first_row_line, guess.doubt);
    layout_.slots = std::move(guess.slots);
    layout_.counter = guess.counter;
    layout_.warnings = std::move(guess.warnings);
    layout_.remark = std::move(guess.remark);
    layout_.source = "without names, by their numbers";
  }

  [[noreturn]] void refuse_guess(std::uint64_t line, const std::string& doubt) const {
    throw ReadError(file_.name(), fmt::format("line {}", line),
                    "the rows of numbers cannot be interpreted as points: " + doubt, kNameColumns);
  }

  InputFile& file_;
  TextLayout layout_;
  std::vector<TextRow> rows_;
  SplitDecimals split_;
  std::size_t row_bytes_ = 0;
  std::uint64_t first_other_line_ = 0;
  std::string first_other_text_;
  std::uint64_t counts_line_ = 0;  // first line of two or more counts
  std::string counts_text_;
  std::size_t other_fields_ = 0;
  bool other_is_numbers_ = false;
};

}  // namespace

bool TextLayout::has(Slot slot) const {
  return std::find(slots.begin(), slots.end(), slot) != slots.end();
}

std::string_view text_of_line(std::string_view line) {
  line = trim(line);
  if (line.starts_with('%') || line.starts_with('!')) return {};
  std::size_t end = line.find('#');
  // "1.#QNAN" is a number.
  while (end != std::string_view::npos && end > 0 && line[end - 1] == '.') {
    end = line.find('#', end + 1);
  }
  line = line.substr(0, end);
  line = line.substr(0, line.find("//"));
  return trim(line);
}

bool take_field(std::string_view& rest, char separator, std::string_view& field) {
  if (separator == ' ') {
    field = take_word(rest);
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
      field = field.substr(1, field.size() - 2);
    }
    return !field.empty();
  }
  if (rest.data() == nullptr) return false;
  const std::size_t end = rest.find(separator);
  field = trim(rest.substr(0, end));
  rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = trim(field.substr(1, field.size() - 2));
  }
  return true;
}

bool parse_field(std::string_view field, bool decimal_comma, double& value) {
  if (!decimal_comma) return parse_number(field, value);
  std::array<char, 64> text{};
  if (field.size() > text.size()) return false;
  std::replace_copy(field.begin(), field.end(), text.begin(), ',', '.');
  return parse_number({text.data(), field.size()}, value);
}

TextLayout find_text_layout(InputFile& file, const ColumnMap& columns) {
  return LayoutFinder(file, columns).find();
}

}  // namespace tactree::builder
