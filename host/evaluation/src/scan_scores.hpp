#pragma once
// Accuracy of the controller's float32 code on real scans, against a reference.

#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Builds the scan with the defaults of `tactree build` and compares `probes` results, within a
/// spacing of the surface, with ReferenceSurface:
///   distance_rms_m, distance_max_m, normal_rms_deg, normal_max_deg, depth_rms_m  everywhere
///   smooth_...                             these scores away from creases
///   creased                                fraction of the compared probes near a crease
///   answered                               fraction of the probes with a result
[[nodiscard]] ScanResult score_scan(const std::filesystem::path& file, int probes,
                                    std::uint32_t seed);

}  // namespace tactree::evaluation
