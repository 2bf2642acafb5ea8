#pragma once
// A real scan: the float32 answer of the controller's code against the reference.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Builds the scan as `tactree build` does by default and compares `probes` answers, within a
/// spacing of the surface, with ReferenceSurface:
///   distance_rms_m, distance_max_m, normal_rms_deg, normal_max_deg, depth_rms_m  everywhere
///   smooth_...                             the same where no crease is near
///   creased                                share of the probes with a crease near
///   answered                               share of the probes with an answer
[[nodiscard]] ScanResult score_scan(const std::filesystem::path& file, int probes,
                                    std::uint32_t seed);

}  // namespace tactree::evaluation
