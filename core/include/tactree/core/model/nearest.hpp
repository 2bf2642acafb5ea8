#pragma once
// Exact neighbour queries by the eight-corner rule.
//
// Interrupt safety: pure functions.

#include <cstdint>

#include "tactree/core/model/blob.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFFU;

struct NearestPoint {
  std::uint32_t index = kNoPoint;
  float distance_squared = 0.0F;  ///< m^2
  Vec3 position{};                ///< m, model frame
  std::uint32_t leaf = 0;         ///< number of its leaf
  [[nodiscard]] bool found() const { return index != kNoPoint; }
};

/// The point nearest to `probe` (m) within distance r (m). Of equally near points, the one with the
/// lowest index is returned. Nothing is found unless 0 <= r <= view.reach_m().
/// Cost: at most 8 leaves with header().points_per_query_max points.
[[nodiscard]] NearestPoint nearest_within(const BlobView& view, Vec3 probe, float r);

/// True if `probe` is in the axis-aligned box, with edge header().aabb_edge_m, around any point.
/// Exact; the boxes are closed. Returns false if aabb_edge_m / 2 > reach_m(), which open_blob()
/// excludes in the surface profile. Cost: as for nearest_within().
[[nodiscard]] bool in_any_vertex_box(const BlobView& view, Vec3 probe);

}  // namespace tactree::core
