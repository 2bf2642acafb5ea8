#pragma once
// Checks whether the controller can run on this board, without requesting any line, channel or
// watchdog.

#include <string>
#include <vector>

#include "controller_file.hpp"

namespace tactree::controller {

struct Finding {
  std::string what;   ///< for example "encoder 0 a"
  std::string which;  ///< its name in the file
  bool good = true;
  bool matters = true;  ///< false: only a warning if it is not good
  std::string detail;   ///< location, or cause and hint
};

[[nodiscard]] std::vector<Finding> examine(const ControllerFile& file);

/// Prints the findings as a table. Returns an exit code, which is 0 if all findings that matter are
/// good.
[[nodiscard]] int print_findings(const std::vector<Finding>& findings);

}  // namespace tactree::controller
