#pragma once
// Selection of the spacing and of the points at that spacing.

#include "cleaning/cleaning.hpp"
#include "geometry/z_order.hpp"
#include "tactree/builder/build_model.hpp"

namespace tactree::builder {

struct DensityChoice {
  double spacing_m = 0.0;
  ZOrderedCloud points;          ///< resampled; normals as read, or zero
  ZOrderedCloud dense;           ///< the candidates from which `points` was selected
  double dense_spacing_m = 0.0;  ///< of `dense`
};

/// Chooses the spacing (as requested, the scan's own, or the finest that fits the flash budget) and
/// the points. A spacing finer than that of a cloud is raised to it, with a warning. Notes go to
/// `report`. Throws std::runtime_error if a budget is too small or a mesh too large for the
/// spacing.
[[nodiscard]] DensityChoice choose_density(CleanInput& input, const BuildOptions& options,
                                           Progress& progress, BuildReport& report);

/// Drops points until no ball of the model's reach holds more points than the controller's limit of
/// candidates. Returns the number of points dropped.
std::uint64_t thin_to_candidates(ZOrderedCloud& points, double spacing);

}  // namespace tactree::builder
