#pragma once
// Normals for points that came without.

#include <cstdint>
#include <span>
#include <vector>

#include "z_order.hpp"

namespace tactree::builder {

/// For each of `points` whose normal is unknown, the direction in which its neighbours in the
/// `dense` cloud vary least (weighted principal components over a radius of about 1.5 spacings, 12
/// neighbours at least, 96 at most); the sign is arbitrary. Known normals are left alone.
/// Cost: about 10 us a point a core.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_normals(const ZOrderedCloud& points,
                                                            const ZOrderedCloud& dense,
                                                            double spacing, double dense_spacing);

/// Gives the normals one side. `fixed`: normals that were read (empty: none); they keep their sign
/// and hand it on. Else each connected piece is turned outward as its extreme points tell; a piece
/// that has no outside (an open sheet) is turned so that most of it faces +z.
///
/// Kruskal's spanning tree over the graph of near neighbours, most certain edges first, with a
/// union-find that carries the relative sign. On a sphere through both points the one normal is the
/// mirror image of the other in the plane between them (up to sign): this is compared, so that sign
/// passes around edges too. No edge leads through a thin plate.
/// Deterministic. Cost: about 5 us a point.
/// Returns the number of connected pieces.
std::uint32_t orient_normals(const ZOrderedCloud& points, std::span<Eigen::Vector3f> normals,
                             const std::vector<bool>& fixed, double spacing);

}  // namespace tactree::builder
