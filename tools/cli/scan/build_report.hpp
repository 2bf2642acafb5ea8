#pragma once
// The report of a build as text.

#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::cli {

/// Prints the report on standard output. `output` is the name of the blob.
void print_report(const builder::BuildReport& report, const builder::BuildOptions& build,
                  const std::string& output);

/// Prints time, CPU time, points and memory of each step.
void print_stages(const builder::BuildReport& report);

}  // namespace tactree::cli
