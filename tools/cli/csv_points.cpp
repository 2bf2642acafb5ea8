#include "csv_points.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

#include "command.hpp"

namespace tactree::cli {
namespace {

constexpr const char* kSeparators = ",; \t\r";

// How many of the first `wanted` fields are numbers.
std::size_t parse_numbers(const std::string& line, double* values, std::size_t wanted) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t i = 0; i < wanted; ++i) {
    while (at < end && std::strchr(" \t\r", *at) != nullptr) ++at;
    if (at < end && *at == '+') ++at;
    const auto [next, error] = std::from_chars(at, end, values[i]);
    if (error != std::errc{} || (next < end && std::strchr(kSeparators, *next) == nullptr)) {
      return i;
    }
    at = next;
    while (at < end && std::strchr(" \t\r", *at) != nullptr) ++at;
    if (at < end && (*at == ',' || *at == ';')) ++at;
  }
  return wanted;
}

template <std::size_t N>
std::vector<std::array<double, N>> parse(std::istream& in, const std::string& name,
                                         const char* columns) {
  std::vector<std::array<double, N>> rows;
  std::string line;
  bool heading_allowed = true;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const std::size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string::npos || line[start] == '#') {
      continue;
    }
    std::array<double, N> row{};
    const std::size_t read = parse_numbers(line, row.data(), N);
    if (read == 0 && heading_allowed) {
      heading_allowed = false;
      continue;
    }
    heading_allowed = false;
    if (read < N) {
      throw CommandError(fmt::format("{}: line {}: column {} is not a number (each row is {})",
                                     name, number, read + 1, columns));
    }
    for (const double value : row) {
      if (!std::isfinite(value)) {
        throw CommandError(fmt::format("{}: line {}: a value is not finite", name, number));
      }
    }
    rows.push_back(row);
  }
  if (in.bad()) {
    throw CommandError(fmt::format("{}: cannot be read: {}", name, std::strerror(errno)));
  }
  return rows;
}

}  // namespace

template <std::size_t N>
std::vector<std::array<double, N>> read_csv_rows(const std::filesystem::path& file,
                                                 const char* columns) {
  if (file == "-") {
    return parse<N>(std::cin, "standard input", columns);
  }
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw CommandError(fmt::format("{}: is a folder", file.string()));
  }
  std::ifstream in(file);
  if (!in) {
    throw CommandError(fmt::format("{}: cannot be read: {}", file.string(), std::strerror(errno)));
  }
  return parse<N>(in, file.string(), columns);
}

template std::vector<std::array<double, 3>> read_csv_rows<3>(const std::filesystem::path&,
                                                             const char*);
template std::vector<std::array<double, 4>> read_csv_rows<4>(const std::filesystem::path&,
                                                             const char*);

}  // namespace tactree::cli
