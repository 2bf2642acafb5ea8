#pragma once
// What surface mode promises, and whether it holds.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

[[nodiscard]] std::vector<Target> check_targets(const Result& result);

}  // namespace tactree::evaluation
