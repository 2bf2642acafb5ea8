#include "tactree/support/csv.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iostream>

#include "tactree/support/output_file.hpp"

namespace tactree::support {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    return {};
  }
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::optional<double> parse_number(std::string_view cell) {
  if (!cell.empty() && cell.front() == '+') {
    cell.remove_prefix(1);
  }
  double value = 0.0;
  const char* const end = cell.data() + cell.size();
  const auto [parsed, error] = std::from_chars(cell.data(), end, value);
  return error == std::errc{} && parsed == end ? std::optional(value) : std::nullopt;
}

}  // namespace

std::vector<std::string_view> split_csv(std::string_view line, CsvSeparator separator) {
  const std::string_view separators = separator == CsvSeparator::kAny ? ",; \t" : ",";
  std::vector<std::string_view> cells;
  line = trim(line);
  while (true) {
    const std::size_t end = line.find_first_of(separators);
    cells.push_back(trim(line.substr(0, end)));
    if (end == std::string_view::npos) {
      return cells;
    }
    // A comma or semicolon and the blanks around it are one separator.
    std::size_t next = std::min(line.find_first_not_of(kBlanks, end), line.size() - 1);
    if (separators.substr(0, 2).find(line[next]) != std::string_view::npos) {
      next = std::min(line.find_first_not_of(kBlanks, next + 1), line.size());
    }
    line.remove_prefix(next);
  }
}

CsvReader::CsvReader(const std::filesystem::path& file, CsvFormat format)
    : name_(file == "-" ? "standard input" : file.string()),
      format_(format),
      in_(file == "-" ? std::cin : file_),
      is_incomplete_(file.extension() == kIncomplete) {
  if (file != "-") {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
      throw CsvError(fmt::format("{}: is a folder (give the file in it)", name_));
    }
    file_.open(file);
    if (!file_) {
      throw CsvError(fmt::format("{}: cannot be read: {} (check the path and its permissions)",
                                 name_, std::strerror(errno)));
    }
  }
  read_header();
}

std::optional<std::size_t> CsvReader::find_column(std::string_view name) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found == columns_.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - columns_.begin());
}

std::vector<std::size_t> CsvReader::find_columns(
    std::span<const std::array<std::string_view, 3>> names, const std::string& remedy) const {
  std::vector<std::size_t> found;
  for (const std::array<std::string_view, 3>& possible : names) {
    std::optional<std::size_t> column;
    if (columns_.empty()) {
      column = found.size();
    }
    for (const std::string_view name : possible) {
      column = column ? column : find_column(name);
    }
    if (!column) {
      refuse(fmt::format("no column is named {}", possible.front()), remedy);
    }
    found.push_back(*column);
  }
  return found;
}

bool CsvReader::next_row() {
  if (pending_) {
    pending_ = false;
    return true;
  }
  if (!read_line()) {
    return false;
  }
  if (format_.header == CsvHeader::kRequired && cells_.size() != columns_.size()) {
    refuse(fmt::format("{} values, the header has {}", cells_.size(), columns_.size()));
  }
  return true;
}

double CsvReader::number(std::size_t column) const {
  if (column >= cells_.size()) {
    refuse(fmt::format("has no column {}", column + 1));
  }
  const std::optional<double> value = parse_number(cells_[column]);
  const std::string name = column < columns_.size() ? fmt::format(" ({})", columns_[column]) : "";
  if (!value) {
    refuse(fmt::format("column {}{} is not a number: '{}'", column + 1, name, cells_[column]));
  }
  if (!std::isfinite(*value)) {
    refuse(fmt::format("column {}{} is not finite: '{}'", column + 1, name, cells_[column]));
  }
  return *value;
}

void CsvReader::refuse(const std::string& cause, const std::string& remedy) const {
  const std::string hint = remedy.empty() ? "" : fmt::format(" ({})", remedy);
  throw CsvError(fmt::format("{}: line {}: {}{}", name_, line_, cause, hint));
}

bool CsvReader::read_line() {
  while (std::getline(in_, text_)) {
    ++line_;
    if (is_incomplete_ && in_.eof()) {
      return false;
    }
    const std::string_view text = trim(text_);
    if (!text.empty() && text.front() != '#') {
      cells_ = split_csv(text, format_.separator);
      return true;
    }
  }
  if (in_.bad()) {
    throw CsvError(fmt::format("{}: cannot be read: {} (check the disk or the pipe)", name_,
                               std::strerror(errno)));
  }
  return false;
}

void CsvReader::read_header() {
  if (!read_line()) {
    return;
  }
  if (format_.header == CsvHeader::kOptional && parse_number(cells_.front())) {
    pending_ = true;
    return;
  }
  columns_.assign(cells_.begin(), cells_.end());
}

}  // namespace tactree::support
