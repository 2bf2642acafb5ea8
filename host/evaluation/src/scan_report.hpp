#pragma once
// The report of `tactree evaluate --scan`.

#include <string>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// A page of Markdown about the scans of the result, without general measurements.
[[nodiscard]] std::string scan_report(const Result& result);

}  // namespace tactree::evaluation
