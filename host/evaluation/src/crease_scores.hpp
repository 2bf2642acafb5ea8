#pragma once
// Hands that press into creases and slide along them and over them.

#include <cstdint>
#include <vector>

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

[[nodiscard]] std::vector<CreaseResult> measure_creases(bool quick, std::uint32_t seed);

}  // namespace tactree::evaluation
