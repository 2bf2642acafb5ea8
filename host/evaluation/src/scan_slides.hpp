#pragma once
// The force of a hand that slides over a scan or crosses it; its true surface is unknown.

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "tactree/core/model/blob.hpp"
#include "tactree/evaluation/evaluation.hpp"

namespace tactree::evaluation {

/// Slides from random points of the blob, in random directions, in surface mode and without
/// friction. The hand follows the computed surface at a constant depth of 1 mm, or one spacing if
/// that is less, so the force is constant where the surface is smooth. At the start of each slide,
/// hands also cross the surface against its normal. Precondition: `points` is not empty.
[[nodiscard]] SlideScores slide_over(const core::BlobView& view,
                                     std::span<const Eigen::Vector3d> points, int slides,
                                     std::uint32_t seed);

}  // namespace tactree::evaluation
