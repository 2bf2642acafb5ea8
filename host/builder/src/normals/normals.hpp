#pragma once
// Estimation of normals. Their signs are determined in normals/orient_cloud.hpp.

#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

/// Normals for the points whose normal is unknown: the direction of least variance of the
/// neighbours in `dense` (weighted principal components over a radius of about 1.5 spacings, 12 to
/// 96 neighbours), with an arbitrary sign. Known normals are returned unchanged. Cost: about 10 us
/// per point and core.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_normals(const ZOrderedCloud& points,
                                                            const ZOrderedCloud& dense,
                                                            double spacing, double dense_spacing);

}  // namespace tactree::builder
