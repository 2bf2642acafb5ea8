#pragma once
// Files with the path of a hand.

#include <filesystem>

#include "tactree/simulation/hand_path.hpp"

namespace tactree::setup {

/// Reads a table of waypoints: the columns t_s, x, y and z (s, m) by the names of the first row, or
/// the only four columns. "-": standard input. Throws support::CsvError.
[[nodiscard]] simulation::HandPath read_path_file(const std::filesystem::path& file);

}  // namespace tactree::setup
