#pragma once
// The measurements of an evaluation.

#include <cstdint>
#include <vector>

#include "subjects.hpp"
#include "tactree/core/configuration/configuration.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Number of samples.
struct Effort {
  int probes = 20'000;  // distance and normal
  int sticky = 1000;    // descents to 1 mm above the surface
  int crossings = 200;  // at each speed
};

/// All scores of one mode on one shape:
///   distance_rms_m, distance_max_m  distance of the computed surface point from the true surface
///   depth_rms_m                     error of the computed distance
///   normal_rms_deg, normal_max_deg  error of the computed normal (paper: direction of the force)
///   answered                        fraction of the probes with a result
///   force_error_rms_N, force_step_max_N, contact_lost, slide_ticks
///                                   sliding 1 mm deep at 0.1 m/s, 1 N/mm
///   sticky                          fraction of the probes 1 mm outside with an attractive force
///   crossings_missed, crossings     at 0.05 .. 6 m/s
///   friction_min, friction_max      tangential / normal force while slipping; mu_d = 0.3
[[nodiscard]] Scores score_shape(const Subject& subject, Mode mode, const Effort& effort,
                                 std::uint32_t seed);

/// The force along the subject's first path in both modes.
[[nodiscard]] ForceTrace trace_force(const Subject& subject);

/// Builds the scan with the defaults of `tactree build`, scaled to kModelEdge_m unless scans are
/// evaluated alone. Slides over it, see slide_over(), and compares many results, within a spacing
/// of the surface, with ReferenceSurface:
///   distance_rms_m, distance_max_m, normal_rms_deg, normal_max_deg, depth_rms_m  everywhere
///   smooth_...                             these scores away from creases
///   creased                                fraction of the compared probes near a crease
///   answered                               fraction of the probes with a result
[[nodiscard]] ScanResult score_scan(const std::filesystem::path& file, const Options& options);

// The paper's experiments on the surface z = cos x + cos y over half a metre.

/// Table 1, contact detection: 6 820 probes per row, h as stated, a = s = 2.5 mm in paper mode.
/// Surface mode detects contact within the paper's margin of 5 um plus one step of the blob's
/// lattice.
[[nodiscard]] std::vector<DetectionRow> measure_detection(std::uint32_t seed);

/// Table 2, distance to the surface: probes from 50 mm below to 10 mm above it.
[[nodiscard]] DistanceTable measure_distances(std::uint32_t seed, int probes);

/// Number of orientations of each crease.
inline int crease_turns(bool quick) { return quick ? 2 : 12; }

/// Contact of hands that press into creases, slide along them, and cross them.
[[nodiscard]] std::vector<CreaseResult> measure_creases(bool quick, std::uint32_t seed);

/// Contact of hands on stairs, in and on corners, and on two bodies that form one surface.
void measure_courses(bool quick, std::uint32_t seed, Result& result);

/// Hands that start inside a body.
[[nodiscard]] std::vector<InsideResult> measure_inside(bool quick, std::uint32_t seed);

/// Measures the vibration while a hand presses with 1 N and moves over the coarse cosine sheet at
/// 10 mm/s (1 kHz, 1 N/mm, encoder step 20 um), the maximum stable stiffness of a device with
/// b = 0.5 Ns/m without a hand at 1, 4 and 10 kHz, and the stability limits of LoopResult::Limit.
[[nodiscard]] LoopResult measure_loop(bool quick);

/// The targets of surface mode.
[[nodiscard]] std::vector<Target> check_targets(const Result& result);

}  // namespace tactree::evaluation
