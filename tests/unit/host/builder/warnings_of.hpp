#pragma once
// The warnings of a build.

#include <string>
#include <utility>
#include <vector>

#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

inline std::vector<std::string> warnings_of(Scan scan, const BuildOptions& options = {}) {
  std::vector<Scan> scans;
  scans.push_back(std::move(scan));
  Progress quiet;
  return build_model(std::move(scans), options, quiet).report.warnings;
}

}  // namespace tactree::builder
