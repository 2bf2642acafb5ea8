#pragma once
// Contact of hands that press into creases, slide along them, and cross them.

#include <cstdint>
#include <vector>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

[[nodiscard]] std::vector<CreaseResult> measure_creases(bool quick, std::uint32_t seed);

}  // namespace tactree::evaluation
