#pragma once
// Evidence in the numbers of a table without column names: unit normals, colours, and the signs
// that its rows are not points.

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "text_columns.hpp"

namespace tactree::builder {

/// Statistics of a column.
struct Column {
  bool numbers = true;   ///< a number in every row
  bool whole = true;     ///< only whole numbers
  bool constant = true;  ///< one value
  bool rises = true;     ///< each value is above the previous one
  bool falls = true;     ///< each value is below the previous one
  bool never_falls = true;
  bool never_rises = true;
  std::size_t steps = 0;   ///< values that are one above the previous one
  std::size_t wholes = 0;  ///< whole numbers
  double first = 0.0;
};

[[nodiscard]] bool is_whole(double value);

/// All rows must have this column.
[[nodiscard]] Column column_of(std::span<const TextRow> rows, std::size_t at);

/// True if nearly all rows have a unit (or missing) vector in three columns from this one.
[[nodiscard]] bool are_normals(std::span<const TextRow> rows, std::size_t column);

/// True if three columns from this one hold only the numbers 0 to 255.
[[nodiscard]] bool are_bytes(std::span<const TextRow> rows, std::size_t column);

/// True if three columns of bytes are as small as classes, counts or flags.
[[nodiscard]] bool are_small(std::span<const TextRow> rows, std::size_t column);

/// A table whose columns have been assigned by a guess.
struct GuessedTable {
  std::span<const TextRow> rows;  ///< each with at least this number of columns:
  std::size_t columns = 0;
  std::span<const Slot> slots;  ///< per column
  std::optional<std::size_t> counter;
};

/// Returns why the first three columns, or those after the counter, may not be x, y and z; empty if
/// nothing is against it.
[[nodiscard]] std::string doubt_of_positions(const GuessedTable& table);

}  // namespace tactree::builder
