#pragma once
// The report of a build, as text and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::cli {

[[nodiscard]] nlohmann::ordered_json report_json(const builder::BuildReport& report,
                                                 const builder::BuildOptions& build);

/// Prints the report on standard output. `output` is the name of the blob.
void print_report(const builder::BuildReport& report, const builder::BuildOptions& build,
                  const std::string& output);

}  // namespace tactree::cli
