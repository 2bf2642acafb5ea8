#pragma once
// The targets of surface mode.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

[[nodiscard]] std::vector<Target> check_targets(const Result& result);

}  // namespace tactree::evaluation
