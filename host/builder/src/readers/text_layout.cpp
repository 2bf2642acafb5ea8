#include "text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "number.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kSampleRows = 1000;
constexpr std::size_t kSampleLines = 4000;  // sample: lines before the rows and rows
constexpr std::size_t kMaxColumns = 4096;
constexpr std::size_t kMinColumns = 3;
constexpr const char* kNotPoints =
    "a text file of points has rows of numbers, x y z first or under a line of column names";

using Row = std::vector<double>;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "1,5 2,5 3,5": every comma between digits, at most one in a word, three words or more.
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
  return words >= kMinColumns;
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

/// False if a required field is not a number: a named column, or one of the first three without
/// names. Other fields that are not numbers become NaN.
bool parse_row(std::string_view line, const TextLayout& layout, Row& row) {
  row.clear();
  std::string_view field;
  while (row.size() < kMaxColumns && take_field(line, layout.separator, field)) {
    const std::size_t column = row.size();
    const bool named = column < layout.slots.size() && layout.slots[column] != kNoSlot;
    const bool needed = layout.slots.empty() ? column < kMinColumns : named;
    double value = 0;
    if (!parse_field(field, layout.decimal_comma, value)) {
      if (needed) return false;
      value = std::numeric_limits<double>::quiet_NaN();
    }
    row.push_back(value);
  }
  return true;
}

/// "x [m]", "//X", "\"X\"" -> "x": the name without its unit.
std::string_view bare_name(std::string_view field) {
  while (field.starts_with('/') || field.starts_with('#')) field.remove_prefix(1);
  return trim(field.substr(0, field.find_first_of("[(")));
}

bool read_column_names(std::string_view line, TextLayout& layout) {
  std::vector<Slot> slots;
  std::array<bool, kSlots> filled{};
  line = trim(line);
  while (line.starts_with('/') || line.starts_with('#')) line.remove_prefix(1);
  line = trim(line);
  char separator = ' ';
  if (line.find(',') != std::string_view::npos) separator = ',';
  if (line.find(';') != std::string_view::npos) separator = ';';
  std::string_view field;
  while (slots.size() < kMaxColumns && take_field(line, separator, field)) {
    Slot slot = slot_of_name(bare_name(field));
    if (slot != kNoSlot && filled[slot]) slot = kNoSlot;
    if (slot != kNoSlot) filled[slot] = true;
    slots.push_back(slot);
  }
  if (!filled[kX] || !filled[kY] || !filled[kZ]) return false;
  layout.slots = std::move(slots);
  return true;
}

void forget_incomplete(std::vector<Slot>& slots) {
  const auto has = [&](Slot slot) {
    return std::find(slots.begin(), slots.end(), slot) != slots.end();
  };
  const bool normals = has(kNx) && has(kNy) && has(kNz);
  const bool colours = has(kRed) && has(kGreen) && has(kBlue);
  for (Slot& slot : slots) {
    if (slot >= kNx && slot <= kNz && !normals) slot = kNoSlot;
    if (slot >= kRed && slot <= kBlue && !colours) slot = kNoSlot;
  }
}

/// Whether nearly all rows have a unit (or missing) vector at this column.
bool are_normals(const std::vector<Row>& rows, std::size_t column) {
  std::size_t unit = 0;
  std::size_t missing = 0;
  for (const Row& row : rows) {
    const double length = std::hypot(row[column], row[column + 1], row[column + 2]);
    if (std::abs(length - 1.0) < 0.02) ++unit;
    if (length == 0.0 || std::isnan(length)) ++missing;
  }
  return unit > 0 && 20 * (unit + missing) >= 19 * rows.size() && 2 * unit >= rows.size();
}

bool are_bytes(const std::vector<Row>& rows, std::size_t column) {
  return std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
    return std::all_of(row.begin() + static_cast<std::ptrdiff_t>(column),
                       row.begin() + static_cast<std::ptrdiff_t>(column) + 3, [](double value) {
                         return value >= 0 && value <= 255 && value == std::floor(value);
                       });
  });
}

/// Without column names: x y z, then normals and colours as recognised by their values.
void guess_columns(const std::vector<Row>& rows, TextLayout& layout) {
  const std::size_t columns = rows.front().size();
  layout.slots.assign(columns, kNoSlot);
  layout.slots[0] = kX;
  layout.slots[1] = kY;
  layout.slots[2] = kZ;
  // PTS: x y z intensity r g b.
  std::size_t at = layout.declared && columns >= 7 ? 4 : 3;
  bool normals = false;
  bool colours = false;
  while (at + 3 <= columns) {
    Slot first = kNoSlot;
    if (!normals && are_normals(rows, at)) {
      first = kNx;
      normals = true;
    } else if (!colours && are_bytes(rows, at)) {
      first = kRed;
      colours = true;
    }
    if (first == kNoSlot) {
      ++at;
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      layout.slots[at + k] = static_cast<Slot>(static_cast<std::size_t>(first) + k);
    }
    at += 3;
  }
  if (!normals && !colours && columns >= 6) {
    layout.warnings.push_back(
        fmt::format("Columns 4 to {} were ignored: they are neither unit normals nor colours of "
                    "0 to 255, and there is no line of column names.",
                    columns));
  }
}

/// Determines the layout from the first lines.
class LayoutFinder {
 public:
  explicit LayoutFinder(InputFile& file) : file_(file) {}

  TextLayout find() {
    file_.rewind();
    std::string_view line;
    std::size_t lines = 0;
    while (rows_.size() < kSampleRows && lines < kSampleLines && file_.next_line(line)) {
      look_at(line);
      if (!text_of_line(line).empty()) ++lines;
    }
    if (rows_.empty()) refuse();
    layout_.row_bytes = static_cast<double>(row_bytes_) / static_cast<double>(rows_.size());
    settle_columns();
    forget_incomplete(layout_.slots);
    file_.rewind();
    return std::move(layout_);
  }

 private:
  void look_at(std::string_view line) {
    const std::string_view text = text_of_line(line);
    if (text.empty()) {
      // CloudCompare writes the column names after "//".
      if (rows_.empty() && layout_.slots.empty()) (void)take_names(trim(line));
      return;
    }
    if (rows_.empty()) find_separator(text, layout_);
    Row row;
    const bool numbers = parse_row(text, layout_, row);
    if (rows_.empty() && numbers && row.size() == 1 && row[0] >= 0 &&
        row[0] == std::floor(row[0]) && row[0] < 1e15 && !layout_.declared) {
      layout_.declared = static_cast<std::uint64_t>(row[0]);
      return;
    }
    if (!numbers && rows_.empty() && layout_.slots.empty() && take_names(text)) return;
    const bool fits = rows_.empty() || row.size() == rows_.front().size();
    if (numbers && row.size() >= kMinColumns && fits) {
      if (rows_.empty()) layout_.first_row_line = file_.line_number();
      row_bytes_ += line.size() + 1;
      rows_.push_back(std::move(row));
      return;
    }
    note_other(text, numbers);
  }

  bool take_names(std::string_view text) {
    if (!read_column_names(text, layout_)) return false;
    layout_.header_line = file_.line_number();
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

  /// Throws: there is no row of numbers.
  [[noreturn]] void refuse() const {
    if (first_other_line_ == 0) {
      throw ReadError(file_.name(), "", "the text holds no point, only comments or blank lines",
                      "check the export, and export it again");
    }
    const std::string place = fmt::format("line {}", first_other_line_);
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

  void settle_columns() {
    const std::size_t columns = rows_.front().size();
    if (!layout_.slots.empty()) {
      check_names_fit(columns);
      return;
    }
    const bool unnamed_header = first_other_line_ != 0 && !other_is_numbers_ &&
                                first_other_line_ < layout_.first_row_line &&
                                other_fields_ == columns;
    if (unnamed_header) {
      throw ReadError(
          file_.name(), fmt::format("line {}", first_other_line_),
          fmt::format("the column names \"{}\" do not include x, y and z", first_other_text_),
          "rename these columns to x, y and z, or delete the line");
    }
    guess_columns(rows_, layout_);
  }

  void check_names_fit(std::size_t columns) {
    const auto last = std::find_if(layout_.slots.rbegin(), layout_.slots.rend(),
                                   [](Slot slot) { return slot != kNoSlot; });
    const auto needed = static_cast<std::size_t>(layout_.slots.rend() - last);
    if (needed > columns) {
      throw ReadError(file_.name(), fmt::format("line {}", layout_.first_row_line),
                      fmt::format("the row has {} values, but line {} names {} columns", columns,
                                  layout_.header_line, layout_.slots.size()),
                      "export the scan again");
    }
    layout_.slots.resize(columns, kNoSlot);
  }

  InputFile& file_;
  TextLayout layout_;
  std::vector<Row> rows_;
  std::size_t row_bytes_ = 0;
  std::uint64_t first_other_line_ = 0;
  std::string first_other_text_;
  std::size_t other_fields_ = 0;
  bool other_is_numbers_ = false;
};

}  // namespace

bool TextLayout::has(Slot slot) const {
  return std::find(slots.begin(), slots.end(), slot) != slots.end();
}

std::string_view text_of_line(std::string_view line) {
  if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
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

TextLayout find_text_layout(InputFile& file) { return LayoutFinder(file).find(); }

}  // namespace tactree::builder
