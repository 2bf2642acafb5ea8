#pragma once
// Accuracy and contact quality of a mode on a shape.

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

}  // namespace tactree::evaluation
