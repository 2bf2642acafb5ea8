#pragma once
// How fine a model can and may be, and the points of that density.

#include "cleaning.hpp"
#include "tactree/builder/build_model.hpp"
#include "z_order.hpp"

namespace tactree::builder {

struct DensityChoice {
  double spacing_m = 0.0;
  ZOrderedCloud points;          ///< resampled; normals as read, or zero
  ZOrderedCloud dense;           ///< what they were chosen from
  double dense_spacing_m = 0.0;  ///< of `dense`
};

/// Chooses the spacing (as asked, the scan's own, or the finest that the flash budget allows) and
/// the points. A cloud has no more points than it has: where a finer spacing was asked for, it is
/// raised, with a warning. What was decided is told in `report`.
/// Throws std::runtime_error when a budget is too small or a mesh too large for the spacing.
[[nodiscard]] DensityChoice choose_density(CleanInput& input, const BuildOptions& options,
                                           Progress& progress, BuildReport& report);

}  // namespace tactree::builder
