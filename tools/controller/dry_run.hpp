#pragma once
// Would it run here? Looks, and takes nothing: no line, no channel, no watchdog.

#include <string>
#include <vector>

#include "controller_file.hpp"

namespace tactree::controller {

struct Finding {
  std::string what;   ///< "line encoder 0 a"
  std::string which;  ///< its name in the file
  bool good = true;
  bool matters = true;  ///< false: a warning where it is not good
  std::string detail;   ///< where it is, or cause and remedy
};

[[nodiscard]] std::vector<Finding> examine(const ControllerFile& file);

/// Prints the findings as a table. Returns an exit code: 0 where all that matters is good.
[[nodiscard]] int print_findings(const std::vector<Finding>& findings);

}  // namespace tactree::controller
