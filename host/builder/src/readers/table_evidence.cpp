#include "table_evidence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/cloud.hpp"
#include "no_data.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kFewRows = 4;    // minimum number of rows to judge a column
constexpr std::size_t kSomeRows = 20;  // minimum number of rows to judge a pattern
constexpr std::size_t kGridColumns = 9;

/// At least half of the values are fractions.
bool are_fractions(std::span<const TextRow> rows, std::size_t at) {
  const Column column = column_of(rows, at);
  return column.numbers && 2 * column.wholes <= rows.size();
}

bool all_whole(const GuessedTable& table, std::size_t begin, std::size_t end) {
  for (std::size_t at = begin; at < end; ++at) {
    const Column column = column_of(table.rows, at);
    if (!column.numbers || !column.whole) return false;
  }
  return true;
}

/// The counts of a mesh or a grid may have as many columns as the rows after them.
std::string doubt_of_first_row(const GuessedTable& table) {
  if (table.rows.size() < kSomeRows || table.counter) return "";
  const auto is_count = [](double value) { return is_whole(value) && value >= 1.0; };
  const auto first_three = [](const TextRow& row) { return std::span(row.values).first(3); };
  const auto counts = first_three(table.rows.front());
  if (!std::all_of(counts.begin(), counts.end(), is_count)) return "";
  for (const TextRow& row : table.rows.subspan(1)) {
    const auto values = first_three(row);
    if (std::all_of(values.begin(), values.end(), is_whole)) return "";
  }
  return "the first row alone consists of whole numbers, like the counts of a mesh or a grid";
}

/// Rows such as "3 0 1 2" are faces.
std::string doubt_of_corner_counts(const GuessedTable& table) {
  if (table.counter || table.columns < 4 || table.rows.size() < kFewRows) return "";
  const Column first = column_of(table.rows, 0);
  if (!first.constant || !first.whole || first.first < 3 || first.first > 8) return "";
  if (!all_whole(table, 1, table.columns)) return "";
  return fmt::format("every row consists of {} and other integers, like the faces of a mesh",
                     static_cast<int>(first.first));
}

using Key = std::array<std::int64_t, 3>;

/// Share of the keys that occur twice; 0 if more than a few occur more often.
double share_of_pairs(std::vector<Key>& keys) {
  std::sort(keys.begin(), keys.end());
  std::size_t distinct = 0;
  std::size_t twice = 0;
  std::size_t more = 0;
  for (auto at = keys.begin(); at != keys.end();) {
    const auto end = std::upper_bound(at, keys.end(), *at);
    ++distinct;
    if (end - at == 2) ++twice;
    if (end - at > 2) ++more;
    at = end;
  }
  constexpr std::size_t kFew = 33;  // one of so many
  if (distinct == 0 || kFew * more > distinct) return 0.0;
  return static_cast<double>(twice) / static_cast<double>(distinct);
}

/// Columns that may hold the corners of faces: whole numbers that vary.
std::vector<std::size_t> corner_columns(const GuessedTable& table) {
  std::vector<std::size_t> columns;
  for (std::size_t at = table.counter ? 1 : 0; at < table.columns; ++at) {
    const Column column = column_of(table.rows, at);
    if (!column.numbers || !column.whole) return {};
    if (!column.constant) columns.push_back(at);
  }
  if (columns.size() > 4) columns.clear();
  return columns;
}

/// Pairs and triples of neighbouring corners.
struct CornerKeys {
  std::vector<Key> edges;
  std::vector<Key> sides;  ///< of tetrahedra
  std::size_t faces = 0;   ///< rows of different corners from 0

  void add(std::vector<std::int64_t> corners) {
    const std::size_t count = corners.size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto [low, high] = std::minmax(corners[i], corners[(i + 1) % count]);
      edges.push_back({low, high, 0});
    }
    std::sort(corners.begin(), corners.end());
    const bool distinct = std::adjacent_find(corners.begin(), corners.end()) == corners.end();
    if (distinct && corners.front() >= 0) ++faces;
    if (count != 4) return;
    sides.push_back({corners[1], corners[2], corners[3]});
    sides.push_back({corners[0], corners[2], corners[3]});
    sides.push_back({corners[0], corners[1], corners[3]});
    sides.push_back({corners[0], corners[1], corners[2]});
  }
};

/// In a mesh, two triangles share each edge, and two tetrahedra each side. Whole numbers that are
/// coordinates repeat less often, or more often.
std::string doubt_of_connectivity(const GuessedTable& table) {
  if (table.rows.size() < kSomeRows) return "";
  const std::vector<std::size_t> columns = corner_columns(table);
  if (columns.size() < 3) return "";
  CornerKeys keys;
  for (const TextRow& row : table.rows) {
    std::vector<std::int64_t> corners;
    for (const std::size_t at : columns) {
      corners.push_back(static_cast<std::int64_t>(row.values[at]));
    }
    keys.add(std::move(corners));
  }
  constexpr double kShared = 0.25;
  if (100 * keys.faces < 99 * table.rows.size()) return "";
  if (share_of_pairs(keys.edges) < kShared && share_of_pairs(keys.sides) < kShared) return "";
  return "the rows consist of integers that repeat like the corners of the faces of a mesh";
}

/// A time rises from row to row, and three coordinates follow it. Points that are sorted by x look
/// the same if a fourth column has fractions.
std::string doubt_of_time(const GuessedTable& table) {
  if (table.counter || table.columns < 4 || table.rows.size() < kFewRows) return "";
  const Column first = column_of(table.rows, 0);
  if (!first.numbers || (!first.never_falls && !first.never_rises)) return "";
  if (first.whole && first.falls) return "column 1 falls from row to row, like a number";
  // In a raster, a wide row looks the same, but its second coordinate hardly changes.
  const bool placed = table.slots[3] != kNoSlot || column_of(table.rows, 1).constant;
  if (table.rows.size() < kSomeRows || placed || first.constant) return "";
  for (std::size_t at = 1; at < 4; ++at) {
    if (!are_fractions(table.rows, at)) return "";
  }
  return fmt::format(
      "column 1 {} from row to row, like a time, and three columns of fractions follow",
      first.never_falls ? "never falls" : "never rises");
}

/// Longitudes and latitudes before heights in metres.
std::string doubt_of_degrees(const GuessedTable& table) {
  if (table.rows.size() < kSomeRows) return "";
  const std::size_t begin = table.counter ? 1 : 0;
  Box box;
  for (const TextRow& row : table.rows) {
    const Eigen::Map<const Eigen::Vector3d> p(row.values.data() + begin);
    if (p.allFinite() && !is_no_data_value(p.z())) box.extend(p);
  }
  if (box.isEmpty()) return "";
  constexpr double kMostDegrees = 360.0;
  constexpr double kFlatter = 1000.0;
  const Eigen::Vector3d sizes = box.sizes();
  const double wide = std::max(sizes.x(), sizes.y());
  const bool angles = box.min().head<2>().minCoeff() >= -kMostDegrees &&
                      box.max().head<2>().maxCoeff() <= kMostDegrees;
  if (!angles || !(wide > 0.0) || !(kFlatter * wide < sizes.z())) return "";
  return "x and y hardly differ, and z does, like longitude, latitude and height (project them to "
         "metres first)";
}

/// One to three columns of whole numbers before three of fractions: the number of a scan line, a
/// row and a column of the scanner, a colour.
std::string doubt_of_leading_integers(const GuessedTable& table) {
  if (table.counter || table.rows.size() < kFewRows) return "";
  for (std::size_t count = 1; count <= 3 && count + 3 <= table.columns; ++count) {
    if (!all_whole(table, 0, count)) return "";
    bool fractions = true;
    for (std::size_t at = count; at < count + 3; ++at) {
      const bool used = at >= 3 && table.slots[at] != kNoSlot;
      fractions = fractions && !used && are_fractions(table.rows, at);
    }
    if (fractions) {
      return fmt::format(
          "{} whole numbers, and the next three fractions; the former may be "
          "numbers of rows or points, the latter x, y and z",
          count == 1 ? "column 1 has" : fmt::format("columns 1 to {} have", count));
    }
  }
  return "";
}

std::string doubt_of_leading_normals(const GuessedTable& table) {
  if (table.counter || table.columns < 6 || table.rows.size() < kSomeRows) return "";
  if (!are_normals(table.rows, 0)) return "";
  for (std::size_t at = 3; at < 6; ++at) {
    if (table.slots[at] != kNoSlot || !are_fractions(table.rows, at)) return "";
  }
  return "the first three columns are unit vectors, like normals before x, y and z";
}

/// Poses and lines are not a surface.
std::string doubt_of_constants(const GuessedTable& table) {
  if (table.counter || table.columns < 4 || table.rows.size() < kSomeRows) return "";
  int constant = 0;
  for (std::size_t at = 0; at < 3; ++at) constant += column_of(table.rows, at).constant ? 1 : 0;
  return constant < 2 ? "" : "two of the first three columns are constant, so there is no surface";
}

/// True for heights in rows: neighbours in a row differ far less than the numbers of the table.
bool is_smooth(const GuessedTable& table) {
  double sum = 0.0;
  double squares = 0.0;
  double steps = 0.0;
  for (const TextRow& row : table.rows) {
    for (std::size_t i = 0; i < table.columns; ++i) {
      sum += row.values[i];
      squares += row.values[i] * row.values[i];
      if (i > 0) steps += std::abs(row.values[i] - row.values[i - 1]);
    }
  }
  const double count = static_cast<double>(table.rows.size() * table.columns);
  const double spread = std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count)));
  constexpr double kSmooth = 0.25;
  const double pairs = static_cast<double>(table.rows.size() * (table.columns - 1));
  return spread > 0.0 && steps / pairs < kSmooth * spread;
}

std::string doubt_of_grid(const GuessedTable& table) {
  if (table.columns < 4) return "";
  const bool whole = table.rows.size() >= kFewRows && all_whole(table, 0, table.columns);
  const auto used = table.columns - static_cast<std::size_t>(std::count(
                                        table.slots.begin(), table.slots.end(), kNoSlot));
  if (used <= 3 && table.columns >= kGridColumns) {
    return fmt::format(
        "{} columns are neither normals nor colours, as in a grid of heights or several points "
        "per row",
        table.columns - 3);
  }
  if (whole && table.columns >= kGridColumns) {
    return fmt::format("all {} columns consist of whole numbers, as in a picture or a grid",
                       table.columns);
  }
  if (table.rows.size() >= kFewRows && (used <= 3 || whole) && is_smooth(table)) {
    return "the numbers of a row hardly differ, as in a grid of heights";
  }
  return "";
}

}  // namespace

bool is_whole(double value) { return value == std::floor(value) && std::abs(value) < 1e15; }

Column column_of(std::span<const TextRow> rows, std::size_t at) {
  Column column;
  column.first = rows.front().values[at];
  double last = column.first;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double value = rows[i].values[at];
    column.numbers = column.numbers && at < rows[i].numbers;
    column.constant = column.constant && value == column.first;
    if (is_whole(value)) ++column.wholes;
    if (i > 0 && !(value > last)) column.rises = false;
    if (i > 0 && !(value < last)) column.falls = false;
    if (i > 0 && !(value >= last)) column.never_falls = false;
    if (i > 0 && !(value <= last)) column.never_rises = false;
    if (i > 0 && value == last + 1.0) ++column.steps;
    last = value;
  }
  column.whole = column.wholes == rows.size();
  return column;
}

bool are_normals(std::span<const TextRow> rows, std::size_t column) {
  std::size_t unit = 0;
  std::size_t missing = 0;
  for (const TextRow& row : rows) {
    const double length =
        std::hypot(row.values[column], row.values[column + 1], row.values[column + 2]);
    if (std::abs(length - 1.0) < 0.02) ++unit;
    if (length == 0.0 || std::isnan(length)) ++missing;
  }
  return unit > 0 && 20 * (unit + missing) >= 19 * rows.size() && 2 * unit >= rows.size();
}

bool are_bytes(std::span<const TextRow> rows, std::size_t column) {
  return std::all_of(rows.begin(), rows.end(), [&](const TextRow& row) {
    const auto first = row.values.begin() + static_cast<std::ptrdiff_t>(column);
    return std::all_of(first, first + 3,
                       [](double value) { return value >= 0 && value <= 255 && is_whole(value); });
  });
}

bool are_small(std::span<const TextRow> rows, std::size_t column) {
  constexpr double kLargest = 31.0;  // classes of LAS 1.0 to 1.3
  return rows.size() >= kSomeRows && std::all_of(rows.begin(), rows.end(), [&](const TextRow& row) {
           const auto first = row.values.begin() + static_cast<std::ptrdiff_t>(column);
           return std::all_of(first, first + 3, [](double value) { return value <= kLargest; });
         });
}

std::string doubt_of_positions(const GuessedTable& table) {
  constexpr std::array kTests = {
      doubt_of_first_row, doubt_of_corner_counts,    doubt_of_connectivity,    doubt_of_time,
      doubt_of_constants, doubt_of_leading_integers, doubt_of_leading_normals, doubt_of_degrees,
      doubt_of_grid};
  for (const auto& test : kTests) {
    if (std::string doubt = test(table); !doubt.empty()) return doubt;
  }
  return "";
}

}  // namespace tactree::builder
