#pragma once
// How many points can a ball of a given radius hold, wherever its centre is?
//
// The controller's scratch for candidate points has a fixed size, so the answer has to be a proven
// bound and not a sample. Branch and bound over cubes of centres: no ball whose centre lies in a
// cube holds more points than the ball of radius r + (half the cube's diagonal) around its middle.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

/// An upper bound of the number of `positions` in any closed ball of `radius`, centred anywhere.
/// At most about 1.2 times the true maximum on surfaces; never below it. Deterministic, whatever
/// the number of threads. Preconditions: finite positions, radius > 0.
/// Cost: about 1 s per million points of a surface with 30 points in a ball, on one core.
[[nodiscard]] std::uint32_t max_points_in_ball(std::span<const Eigen::Vector3d> positions,
                                               double radius);

/// Which points to drop so that no ball of `radius` holds more than `most` of the others: true for
/// a point to keep. In an offending ball the points of lowest `rank` go first (ties: the later
/// index). Deterministic. Cost: as above where nothing is dropped.
[[nodiscard]] std::vector<bool> thin_to_ball_bound(std::span<const Eigen::Vector3d> positions,
                                                   std::span<const std::uint64_t> rank,
                                                   double radius, std::uint32_t most);

}  // namespace tactree::builder
