#pragma once
// Hands that start inside a body.

#include <cstdint>
#include <vector>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

[[nodiscard]] std::vector<InsideResult> measure_inside(bool quick, std::uint32_t seed);

}  // namespace tactree::evaluation
