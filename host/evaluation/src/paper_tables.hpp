#pragma once
// The paper's experiments, done again: z = cos x + cos y over half a metre.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Table 1: is the probe in contact? 6 820 probes a row, h as stated, a = s = 2.5 mm in paper mode.
/// Surface mode says contact when the fitted surface is no further than the paper's margin of 5 um
/// and one step of the blob's lattice.
[[nodiscard]] std::vector<DetectionRow> measure_detection(std::uint32_t seed);

/// Table 2: how far is the surface? Probes from 50 mm below to 10 mm above it.
[[nodiscard]] DistanceTable measure_distances(std::uint32_t seed, int probes);

}  // namespace tactree::evaluation
