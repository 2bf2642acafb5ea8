#pragma once
// Positions from a CSV file.

#include <array>
#include <filesystem>
#include <vector>

namespace tactree::cli {

/// Reads rows of finite numbers, separated by commas, semicolons or blanks: x,y,z first, or under a
/// line that names these columns. Further columns, empty lines and lines that start with '#' are
/// ignored. "-" reads standard input. Throws support::CsvError.
[[nodiscard]] std::vector<std::array<double, 3>> read_points(const std::filesystem::path& file);

}  // namespace tactree::cli
