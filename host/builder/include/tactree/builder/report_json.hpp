#pragma once
// The report of a build as JSON.

#include <string>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

/// Name of material `index` of the blob: "default" or that of a colour of the options.
[[nodiscard]] std::string material_name(const BuildOptions& options, std::size_t index);

[[nodiscard]] double bytes_per_point(const BuildReport& report);

/// The text of `tactree build --report`. `options` are those of the build.
[[nodiscard]] std::string report_json(const BuildReport& report, const BuildOptions& options);

}  // namespace tactree::builder
