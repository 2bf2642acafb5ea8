#pragma once
// The paper's experiments on the surface z = cos x + cos y over half a metre.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Table 1, contact detection: 6 820 probes per row, h as stated, a = s = 2.5 mm in paper mode.
/// Surface mode detects contact within the paper's margin of 5 um plus one step of the blob's
/// lattice.
[[nodiscard]] std::vector<DetectionRow> measure_detection(std::uint32_t seed);

/// Table 2, distance to the surface: probes from 50 mm below to 10 mm above it.
[[nodiscard]] DistanceTable measure_distances(std::uint32_t seed, int probes);

}  // namespace tactree::evaluation
