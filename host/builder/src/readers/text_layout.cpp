#include "text_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "comma_evidence.hpp"
#include "number.hpp"
#include "table_evidence.hpp"
#include "text_columns.hpp"
#include "text_names.hpp"
#include "unit_names.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kSampleRows = 1000;
constexpr std::size_t kSampleLines = 4000;  // of the sample, including those before the rows
constexpr std::size_t kMaxColumns = 4096;
constexpr std::size_t kMinTableColumns = 3;
constexpr std::size_t kFewestNumbered = 4;  // rows of which a column of numbers is recognised
constexpr const char* kNotPoints =
    "a text file of points has rows of numbers, x y z first or under a line of column names; "
    "otherwise name them, as in --columns x=2,y=3,z=4";
constexpr const char* kNumberColumns =
    "give the numbers of the columns, as in --columns x=2,y=3,z=4";
constexpr const char* kNameColumns =
    "if they are points, name the columns, as in --columns x=1,y=2,z=3; else save the scan as PLY";

/// Returns false if a required field is not a number: a named column, or one of the first three
/// columns without names. Other fields that are not numbers become NaN.
bool parse_row(std::string_view line, const TextLayout& layout, TextRow& row) {
  row = {};
  std::string_view field;
  bool all_numbers = true;
  while (row.values.size() < kMaxColumns && take_field(line, layout.style.separator, field)) {
    const std::size_t column = row.values.size();
    const bool named = column < layout.slots.size() && layout.slots[column] != kNoSlot;
    const bool needed = layout.slots.empty() ? column < kMinTableColumns : named;
    double value = 0;
    if (!parse_field(field, layout.style.decimal_comma, value)) {
      if (needed) return false;
      value = std::numeric_limits<double>::quiet_NaN();
      all_numbers = false;
    }
    row.values.push_back(value);
    if (all_numbers) row.numbers = row.values.size();
  }
  return true;
}

/// True for a row such as "830 3 0": several whole numbers and nothing else.
bool are_counts(const TextRow& row) {
  return row.values.size() >= 2 && row.numbers == row.values.size() &&
         std::all_of(row.values.begin(), row.values.end(),
                     [](double value) { return value >= 0 && value == std::floor(value); });
}

struct RowWidths {
  std::size_t columns = 0;  ///< of most rows
  std::size_t fewest = 0;   ///< columns
  std::size_t most = 0;
  std::size_t numbers = 0;  ///< up to the last number of any row
  std::size_t leading = 0;  ///< of numbers at the beginning of every row
  bool numbered = false;    ///< the first column numbers the rows
};

/// Precondition: at least one row.
RowWidths widths_of(std::span<const TextRow> rows) {
  RowWidths widths;
  widths.columns = most_frequent_width(rows);
  widths.fewest = rows.front().values.size();
  widths.leading = rows.front().numbers;
  for (const TextRow& row : rows) {
    widths.fewest = std::min(widths.fewest, row.values.size());
    widths.most = std::max(widths.most, row.values.size());
    for (std::size_t i = widths.numbers; i < row.values.size(); ++i) {
      if (!std::isnan(row.values[i])) widths.numbers = i + 1;
    }
    widths.leading = std::min(widths.leading, row.numbers);
  }
  const Column first = column_of(rows, 0);
  widths.numbered = rows.size() >= kFewestNumbered && first.whole && first.steps + 1 == rows.size();
  return widths;
}

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
    refuse_thousands();
    layout_.row_bytes = static_cast<double>(row_bytes_) / static_cast<double>(rows_.size());
    settle_columns();
    leave_out_unused(layout_.slots);
    layout_.has_commas = thousands_.have_commas();
    file_.rewind();
    return std::move(layout_);
  }

 private:
  void look_at(std::string_view line) {
    const std::string_view text = text_of_line(line);
    if (text.empty()) {
      // CloudCompare writes the column names after "//", others after '%' or '!'.
      if (rows_.empty() && !(layout_.slots.empty() && take_names(trim(line)))) take_unit(line);
      return;
    }
    if (rows_.empty()) layout_.style = style_of_row(text);
    TextRow row;
    bool numbers = parse_row(text, layout_, row);
    // The first rows may consist of whole numbers.
    if (!numbers && layout_.style.separator == ' ' && has_decimal_commas(text)) {
      layout_.style.decimal_comma = true;
      numbers = parse_row(text, layout_, row);
    }
    if (numbers && rows_.empty() && is_count(row)) {
      layout_.declared = static_cast<std::uint64_t>(row.values[0]);
      return;
    }
    const bool unnamed = rows_.empty() && layout_.slots.empty();
    // The '#' of "Point#, X, Y, Z" does not begin a comment.
    if (!numbers && unnamed && (take_names(text) || take_names(trim(line)))) return;
    if (!numbers && rows_.empty() && take_unit(line)) return;
    if (numbers && row.values.size() >= std::max(kMinTableColumns, layout_.slots.size())) {
      if (layout_.style.separator == ',') split_.look_at(text, layout_.slots.size());
      if (layout_.style.decimal_comma) thousands_.look_at(text, layout_.style.separator);
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
    ColumnNames names = read_column_names(text);
    if (names.slots.empty()) return false;
    layout_.slots = std::move(names.slots);
    names_ = names.count;
    contradiction_ = std::move(names.contradiction);
    if (names.unit_m) set_unit(*names.unit_m);
    layout_.header_line = file_.line_number();
    layout_.source = fmt::format("named by line {}", layout_.header_line);
    leave_out_unused(layout_.slots);
    return true;
  }

  void set_unit(double metres) {
    layout_.unit_m = metres;
    layout_.unit_line = file_.line_number();
  }

  /// A line before the first row that states the unit.
  bool take_unit(std::string_view line) {
    if (layout_.header_line != 0) {
      const auto metres = read_column_units(trim(line), layout_.style.separator, layout_.slots);
      if (metres) {
        set_unit(*metres);
        return true;
      }
    }
    const std::string_view unit = stated_unit(trim(line));
    if (unit.empty()) return false;
    if (const auto metres = metres_of_unit(unit)) {
      set_unit(*metres);
    } else {
      layout_.warnings.push_back(
          fmt::format("Line {} states the unit \"{}\", which is not known (--unit states it).",
                      file_.line_number(), printable(unit)));
    }
    return true;
  }

  void note_other(std::string_view text, bool numbers) {
    if (first_other_line_ != 0) return;
    first_other_line_ = file_.line_number();
    first_other_text_ = printable(text);
    std::string_view field;
    other_fields_ = 0;
    const char separator = text.find(',') != text.npos ? ',' : layout_.style.separator;
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
                      by_user ? "check --columns" : kNumberColumns);
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

  void refuse_thousands() const {
    if (!layout_.style.decimal_comma || !thousands_.are_likely()) return;
    throw ReadError(file_.name(), fmt::format("line {}", layout_.first_row_line),
                    "three digits follow every comma, and other numbers have none: the commas "
                    "seem to separate thousands",
                    "export it without them");
  }

  void refuse_split_decimals() const {
    if (layout_.style.separator != ',' || !split_.are_likely()) return;
    throw ReadError(file_.name(), fmt::format("line {}", layout_.first_row_line),
                    "its commas seem to be decimal commas as well as the separators of its columns",
                    "export it with decimal points, or with semicolons between the columns");
  }

  void settle_columns() {
    if (layout_.header_line != 0) compare_names();
    if (!layout_.slots.empty()) return;
    const std::size_t columns = rows_.front().values.size();
    const bool unnamed_header = first_other_line_ != 0 && !other_is_numbers_ &&
                                first_other_line_ < layout_.first_row_line &&
                                other_fields_ == columns;
    if (unnamed_header) {
      throw ReadError(
          file_.name(), fmt::format("line {}", first_other_line_),
          fmt::format("the column names \"{}\" do not include x, y and z", first_other_text_),
          remedy_of_names(first_other_text_));
    }
    ColumnGuess guess = guess_columns(rows_, layout_.declared.has_value());
    if (counts_line_ != 0 && counts_line_ < layout_.first_row_line) {
      refuse_guess(counts_line_,
                   fmt::format("\"{}\" looks like the counts of a mesh or a grid", counts_text_));
    }
    if (!guess.doubt.empty()) refuse_guess(layout_.first_row_line, guess.doubt);
    layout_.slots = std::move(guess.slots);
    layout_.counter = guess.counter;
    layout_.warnings.insert(layout_.warnings.end(), guess.warnings.begin(), guess.warnings.end());
    layout_.remark = std::move(guess.remark);
    layout_.source = "without names, by their numbers";
  }

  /// The names must fit the rows: with a name too many or too few, all columns may be shifted.
  void compare_names() {
    const auto fail = [&](const std::string& cause, const char* remedy) {
      throw ReadError(file_.name(), fmt::format("line {}", layout_.header_line), cause, remedy);
    };
    if (layout_.unit_m == 0.0) {
      throw ReadError(file_.name(), fmt::format("line {}", layout_.unit_line),
                      "x, y and z have different units", "convert them to one unit");
    }
    if (!contradiction_.empty()) fail(contradiction_, kNumberColumns);
    const RowWidths widths = widths_of(rows_);
    if (widths.numbers <= names_ && names_ <= widths.columns) return;
    if (widths.columns == names_ + 1 && widths.numbered) {
      // R and pandas write the numbers of the rows first, without a name.
      layout_.slots.insert(layout_.slots.begin(), kNoSlot);
      layout_.counter = 0;
      layout_.source += ", after the numbers of the rows";
      return;
    }
    const bool first = layout_.slots.size() >= 3 && layout_.slots[0] == kX &&
                       layout_.slots[1] == kY && layout_.slots[2] == kZ;
    // A list at the end of the rows has one name.
    const bool list_last = widths.fewest + 1 < widths.most && layout_.slots.size() <= widths.fewest;
    // Words at the end of a row may be separated by spaces.
    const bool words_last = names_ < widths.columns && layout_.slots.size() <= widths.leading &&
                            widths.leading <= names_ && widths.leading < widths.columns;
    if (first || list_last || words_last) return;
    fail(fmt::format("there are {} names of columns, but the rows have {}", names_, widths.columns),
         kNumberColumns);
  }

  [[noreturn]] void refuse_guess(std::uint64_t line, const std::string& doubt) const {
    throw ReadError(file_.name(), fmt::format("line {}", line),
                    "the rows of numbers cannot be interpreted as points: " + doubt, kNameColumns);
  }

  InputFile& file_;
  TextLayout layout_;
  std::vector<TextRow> rows_;
  SplitDecimals split_;
  Thousands thousands_;
  std::size_t names_ = 0;  // of columns
  std::string contradiction_;
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

TextLayout find_text_layout(InputFile& file, const ColumnMap& columns) {
  return LayoutFinder(file, columns).find();
}

}  // namespace tactree::builder
