#pragma once
// Rows of numbers from a CSV file: query points, paths.

#include <array>
#include <filesystem>
#include <vector>

namespace tactree::cli {

/// Reads rows of at least `N` finite numbers, separated by commas, semicolons or white space;
/// further columns are ignored, as are empty lines, lines that start with # and one heading line.
/// "-" reads standard input. Throws CommandError with file and line.
template <std::size_t N>
[[nodiscard]] std::vector<std::array<double, N>> read_csv_rows(const std::filesystem::path& file,
                                                               const char* columns);

extern template std::vector<std::array<double, 3>> read_csv_rows<3>(const std::filesystem::path&,
                                                                    const char*);
extern template std::vector<std::array<double, 4>> read_csv_rows<4>(const std::filesystem::path&,
                                                                    const char*);

}  // namespace tactree::cli
