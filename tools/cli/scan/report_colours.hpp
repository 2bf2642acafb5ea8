#pragma once
// The colours of a scan, from the report of its build.

#include <string>
#include <vector>

#include "tactree/viewer/point_tree.hpp"

namespace tactree::cli {

/// Empty if `file` is empty. Throws UserError.
[[nodiscard]] std::vector<viewer::ScanColour> report_colours(const std::string& file);

}  // namespace tactree::cli
