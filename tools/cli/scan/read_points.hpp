#pragma once
// Positions from a CSV file.

#include <array>
#include <filesystem>
#include <vector>

namespace tactree::cli {

/// Reads rows of at least three finite numbers x,y,z, separated by commas, semicolons or blanks.
/// Further columns, empty lines, lines that start with '#' and a header are ignored. "-" reads
/// standard input. Throws support::CsvError.
[[nodiscard]] std::vector<std::array<double, 3>> read_points(const std::filesystem::path& file);

}  // namespace tactree::cli
