#pragma once
// Tables of comma-separated values: traces, lists of points.
//
//   CsvReader table(file, {.header = CsvHeader::kRequired});
//   const std::size_t time = table.find_column("t_s").value();
//   while (table.next_row()) {
//     samples.push_back(table.number(time));
//   }
//
// A cell holds no comma, quote or line break. Blanks around a cell, empty lines, lines that start
// with '#' and a carriage return at the end of a line are ignored, and the end of a file of a
// program that was cut off (GrowingFile): in FILE.incomplete, a last line without a line break.

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <istream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tactree::support {

/// The text is "FILE: line N: cause (hint)".
class CsvError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class CsvHeader {
  kRequired,  ///< the first row names the columns
  kOptional,  ///< the first row names the columns if its first cell is not a number
};

enum class CsvSeparator {
  kComma,
  kAny,  ///< a comma, a semicolon or blanks
};

struct CsvFormat {
  CsvHeader header = CsvHeader::kRequired;
  CsvSeparator separator = CsvSeparator::kComma;
};

/// Splits a line into its cells, without the blanks around them. The cells refer to `line`.
[[nodiscard]] std::vector<std::string_view> split_csv(
    std::string_view line, CsvSeparator separator = CsvSeparator::kComma);

/// Reads a table row by row. Keeps one row in memory.
class CsvReader {
 public:
  /// Opens the file, or standard input for "-", and reads the header. All members throw CsvError.
  CsvReader(const std::filesystem::path& file, CsvFormat format);

  /// Names of the columns; empty if there is no header.
  [[nodiscard]] const std::vector<std::string>& columns() const { return columns_; }
  /// Index of the named column; nullopt if the header does not have it.
  [[nodiscard]] std::optional<std::size_t> find_column(std::string_view name) const;
  /// Indices of columns of which each has one of its `names`, the first that the header has; 0, 1,
  /// 2 and so on without a header. `remedy`: what to do if the header lacks one.
  [[nodiscard]] std::vector<std::size_t> find_columns(
      std::span<const std::array<std::string_view, 3>> names, const std::string& remedy) const;

  /// Advances to the next row. Returns false at the end of the file. With a required header, a row
  /// must have as many cells as the header.
  [[nodiscard]] bool next_row();
  /// Cells of the current row; valid until next_row().
  [[nodiscard]] std::span<const std::string_view> cells() const { return cells_; }
  /// Number of the current line, from 1.
  [[nodiscard]] std::size_t line() const { return line_; }
  /// Returns the cell as a finite number. If the row has no such column, the error names the line.
  [[nodiscard]] double number(std::size_t column) const;

  /// Throws CsvError for the current line.
  [[noreturn]] void refuse(const std::string& cause, const std::string& remedy = "") const;

 private:
  bool read_line();
  void read_header();

  std::string name_;
  CsvFormat format_;
  std::ifstream file_;
  std::istream& in_;
  bool is_incomplete_;
  std::size_t line_ = 0;
  std::string text_;
  bool pending_ = false;  // the current row was read together with the header
  std::vector<std::string_view> cells_;
  std::vector<std::string> columns_;
};

}  // namespace tactree::support
