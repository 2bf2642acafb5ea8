#pragma once
// The report of a build as JSON.

#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

[[nodiscard]] double bytes_per_point(const BuildReport& report);

/// The text of `tactree build --report`. `options` are those of the build.
[[nodiscard]] std::string report_json(const BuildReport& report, const BuildOptions& options);

}  // namespace tactree::builder
