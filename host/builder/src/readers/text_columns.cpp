#include "text_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "number.hpp"
#include "table_evidence.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kMinColumns = 3;
constexpr std::size_t kMaxColumnNumber = 4096;
constexpr std::size_t kRowsToCount = 4;  // minimum number of rows to judge a column
constexpr std::array<const char*, kSlots> kNames = {"x",  "y",   "z",     "nx",  "ny",
                                                    "nz", "red", "green", "blue"};

/// For four columns of bytes: true for an intensity before the colour, false for an opacity after
/// it.
bool begins_with_intensity(std::span<const TextRow> rows, std::size_t at) {
  const Column last = column_of(rows, at + 3);
  if (!last.constant || last.first != 255.0) return true;
  // A last column of 255 throughout is an opacity, unless the colour is white throughout.
  const Column red = column_of(rows, at + 1);
  const Column green = column_of(rows, at + 2);
  const Column first = column_of(rows, at);
  return red.constant && green.constant && red.first == 255.0 && green.first == 255.0 &&
         !first.constant;
}

class Guess {
 public:
  Guess(std::span<const TextRow> rows, bool counted) : rows_(rows), counted_(counted) {}

  ColumnGuess find() {
    columns_ = most_frequent_width(rows_);
    check_rows();
    rows_left_.clear();
    for (const TextRow& row : rows_) {
      if (row.values.size() >= columns_) rows_left_.push_back(row);
    }
    if (guess_.doubt.empty()) check_counter();
    place();
    if (guess_.doubt.empty() && columns_ >= kMinColumns) {
      guess_.doubt = doubt_of_positions({rows_left_, columns_, guess_.slots, guess_.counter});
    }
    warn_of_rest();
    return std::move(guess_);
  }

 private:
  /// Rows of points have equal numbers of columns. Text at the end of a row may contain spaces.
  void check_rows() {
    const TextRow& first = rows_.front();
    if (first.values.size() != columns_ && first.numbers == first.values.size() &&
        std::all_of(first.values.begin(), first.values.end(), is_whole) && rows_.size() > 2) {
      guess_.doubt =
          "the first row has integers and differs in length from the rows after it, like the "
          "counts of a mesh or a grid";
      return;
    }
    std::size_t other = 0;
    std::size_t fewest = columns_;
    bool words = true;
    for (const TextRow& row : rows_) {
      if (row.values.size() == columns_) continue;
      ++other;
      fewest = std::min(fewest, row.numbers);
    }
    for (const TextRow& row : rows_) words = words && row.numbers == fewest;
    if (100 * other <= rows_.size()) return;
    if (words) {
      columns_ = fewest;
    } else {
      guess_.doubt = "the rows differ in their number of columns";
    }
  }

  /// The counts of a mesh may have as many columns as the numbered rows after them.
  void check_first_row() {
    const std::span<const TextRow> rest = std::span(rows_left_).subspan(1);
    const Column numbers = column_of(rest, 0);
    const bool consecutive = numbers.whole && numbers.steps == rest.size() - 1;
    const std::vector<double>& first = rows_left_[0].values;
    const bool counts = std::all_of(first.begin(), first.end(), is_whole);
    if (counts && rest.size() >= kRowsToCount && columns_ > kMinColumns && consecutive &&
        first[0] + 1.0 != numbers.first) {
      guess_.doubt =
          "column 1 numbers the rows from the second row on, as after the counts of a mesh";
    }
  }

  /// A first column of rising integers numbers the points.
  void check_counter() {
    if (rows_left_.size() < kRowsToCount || columns_ < kMinColumns) return;
    check_first_row();
    const Column first = column_of(rows_left_, 0);
    const Column second = column_of(rows_left_, 1);
    const Column third = column_of(rows_left_, 2);
    if (!first.numbers || !first.whole || !first.rises) return;
    const bool consecutive = 10 * first.steps >= 9 * (rows_left_.size() - 1);
    if (columns_ == kMinColumns) {
      if (consecutive && !second.whole && !third.whole) {
        guess_.doubt = "column 1 numbers the rows, and only two columns follow";
      }
      return;
    }
    const Column fourth = column_of(rows_left_, 3);
    if (consecutive && !second.constant && !third.constant && !fourth.constant && fourth.numbers) {
      guess_.counter = 0;
    } else {
      guess_.doubt = consecutive ? "column 1 may number the points, or be a coordinate"
                                 : "column 1 rises from row to row, like a number or a time";
    }
  }

  /// Assigns x y z, then normals and colours as recognised by their values.
  void place() {
    guess_.slots.assign(columns_, kNoSlot);
    const std::size_t first = guess_.counter ? 1 : 0;
    if (columns_ < first + kMinColumns) return;
    for (std::size_t k = 0; k < 3; ++k) guess_.slots[first + k] = static_cast<Slot>(k);
    // PTS: x y z intensity r g b.
    std::size_t at = first + (counted_ && columns_ >= 7 ? 4 : 3);
    while (at + 3 <= columns_) {
      const Slot slot = slot_at(at);
      if (slot == kNoSlot) {
        ++at;
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        guess_.slots[at + k] = static_cast<Slot>(static_cast<std::size_t>(slot) + k);
      }
      at += 3;
    }
  }

  /// Normals or colours in the columns from `at`. Moves `at` past columns that are neither.
  Slot slot_at(std::size_t& at) {
    if (!normals_ && are_normals(rows_left_, at)) {
      normals_ = true;
      return kNx;
    }
    if (colours_ || small_ || !are_bytes(rows_left_, at)) return kNoSlot;
    if (are_small(rows_left_, at)) {
      small_ = at;
      at += 2;
      return kNoSlot;
    }
    const bool four = at + 4 <= columns_ && are_bytes(rows_left_, at + 1) &&
                      !(at + 6 <= columns_ && are_normals(rows_left_, at + 3));
    if (four && begins_with_intensity(rows_left_, at)) {
      ++at;
      guess_.remark = fmt::format("column {} is taken for an intensity", at);
    }
    colours_ = true;
    return kRed;
  }

  void warn_of_rest() {
    if (small_ && !colours_) {
      guess_.warnings.push_back(fmt::format(
          "Columns {0} to {1} were ignored: as colours they would be nearly black, so they may be "
          "classes or counts (--columns ...,red={0},green={2},blue={1} takes them as colours).",
          *small_ + 1, *small_ + 3, *small_ + 2));
    } else if (!normals_ && !colours_ && columns_ >= 6) {
      guess_.warnings.push_back(
          fmt::format("Columns {} to {} were ignored: they are neither unit normals nor colours of "
                      "0 to 255, and there is no line of column names.",
                      guess_.counter ? 5 : 4, columns_));
    }
  }

  std::span<const TextRow> rows_;
  bool counted_;
  ColumnGuess guess_;
  std::size_t columns_ = 0;
  std::vector<TextRow> rows_left_;  // rows with at least the common number of columns
  bool normals_ = false;
  bool colours_ = false;
  std::optional<std::size_t> small_;  // first of three columns of small bytes
};

/// Names of coordinates in survey files, for columns that have no other name.
Slot slot_of_survey_name(std::string_view name) {
  struct Name {
    std::string_view name;
    Slot slot;
  };
  constexpr Name kSurvey[] = {
      {"easting", kX},   {"east", kX}, {"e", kX},      {"northing", kY}, {"north", kY}, {"n", kY},
      {"elevation", kZ}, {"elev", kZ}, {"height", kZ}, {"altitude", kZ}, {"h", kZ}};
  for (const Name& known : kSurvey) {
    if (equal_ignoring_case(known.name, name)) return known.slot;
  }
  return kNoSlot;
}

void take(std::vector<Slot>& slots, std::array<bool, kSlots>& filled, std::size_t at, Slot slot) {
  if (slot == kNoSlot || filled[slot] || slots[at] != kNoSlot) return;
  filled[slot] = true;
  slots[at] = slot;
}

}  // namespace

std::size_t most_frequent_width(std::span<const TextRow> rows) {
  std::vector<std::size_t> widths;
  for (const TextRow& row : rows) widths.push_back(row.values.size());
  std::sort(widths.begin(), widths.end());
  std::size_t best = 0;
  std::size_t width = kMinColumns;
  for (auto at = widths.begin(); at != widths.end();) {
    const auto end = std::upper_bound(at, widths.end(), *at);
    if (static_cast<std::size_t>(end - at) > best) {
      best = static_cast<std::size_t>(end - at);
      width = *at;
    }
    at = end;
  }
  return width;
}

ColumnGuess guess_columns(std::span<const TextRow> rows, bool counted) {
  return Guess(rows, counted).find();
}

std::vector<Slot> slots_of_names(std::span<const std::string_view> names) {
  std::vector<Slot> slots(names.size(), kNoSlot);
  std::array<bool, kSlots> filled{};
  for (std::size_t i = 0; i < names.size(); ++i) take(slots, filled, i, slot_of_name(names[i]));
  if (!filled[kX] && !filled[kY]) {
    for (std::size_t i = 0; i < names.size(); ++i) {
      take(slots, filled, i, slot_of_survey_name(names[i]));
    }
  }
  if (!filled[kX] || !filled[kY] || !filled[kZ]) return {};
  return slots;
}

std::vector<Slot> slots_of_columns(const ColumnMap& columns) {
  std::vector<Slot> slots;
  for (const auto& [name, number] : columns) {
    if (number > slots.size()) slots.resize(number, kNoSlot);
    slots[number - 1] = slot_of_name(name);
  }
  return slots;
}

void leave_out_unused(std::vector<Slot>& slots) {
  const auto has = [&](Slot slot) {
    return std::find(slots.begin(), slots.end(), slot) != slots.end();
  };
  const bool normals = has(kNx) && has(kNy) && has(kNz);
  const bool colours = has(kRed) && has(kGreen) && has(kBlue);
  for (Slot& slot : slots) {
    if (slot >= kNx && slot <= kNz && !normals) slot = kNoSlot;
    if (slot >= kRed && slot <= kBlue && !colours) slot = kNoSlot;
  }
  while (!slots.empty() && slots.back() == kNoSlot) slots.pop_back();
}

std::string describe_columns(std::span<const Slot> slots) {
  std::string text;
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    const auto at = std::find(slots.begin(), slots.end(), static_cast<Slot>(slot));
    if (at == slots.end()) continue;
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", kNames[slot], at - slots.begin() + 1);
  }
  return text;
}

ColumnMap parse_columns(std::string_view text) {
  ColumnMap columns;
  const auto fail = [&](const std::string& cause) {
    throw std::invalid_argument(cause + ", as in x=2,y=3,z=4");
  };
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view entry = trim(text.substr(begin, end - begin));
    begin = end + 1;
    const std::size_t equals = entry.find('=');
    const Slot slot = slot_of_name(trim(entry.substr(0, equals)));
    std::int64_t number = 0;
    const bool numbered = equals != std::string_view::npos &&
                          parse_integer(trim(entry.substr(equals + 1)), number) && number >= 1 &&
                          number <= static_cast<std::int64_t>(kMaxColumnNumber);
    if (slot == kNoSlot || !numbered) {
      fail(
          fmt::format("'{}' is not one of x, y, z, nx, ny, nz, red, green, blue with the number of "
                      "a column from 1",
                      printable(entry)));
    }
    for (const auto& [name, other] : columns) {
      if (name == kNames[slot] || other == static_cast<std::size_t>(number)) {
        fail(fmt::format("'{}' names a column twice", printable(entry)));
      }
    }
    columns[kNames[slot]] = static_cast<std::size_t>(number);
  }
  for (std::size_t first = 0; first < kSlots; first += 3) {
    std::size_t named = 0;
    for (std::size_t k = 0; k < 3; ++k) named += columns.count(kNames[first + k]);
    if (named != 3 && (named != 0 || first == 0)) {
      fail(fmt::format("{}, {} and {} are needed", kNames[first], kNames[first + 1],
                       kNames[first + 2]));
    }
  }
  return columns;
}

}  // namespace tactree::builder
