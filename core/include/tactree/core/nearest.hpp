#pragma once
// Exact neighbour queries by the eight-corner rule: every point of the answer, and no other.

#include <cstdint>
#include <span>

#include "tactree/core/blob.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFFU;

struct NearestPoint {
  std::uint32_t index = kNoPoint;
  float distance_squared = 0.0F;  ///< m^2
  Vec3 position{};                ///< m, model frame
  std::uint32_t leaf = 0;         ///< number of its leaf
  [[nodiscard]] bool found() const { return index != kNoPoint; }
};

/// The point nearest to `probe` among those with distance <= r; of equally near ones, the one with
/// the lowest index. Precondition: 0 <= r <= view.reach_m(); else nothing is found.
/// Cost: at most 8 leaves, header().points_per_query_max points. Interrupt safe.
[[nodiscard]] NearestPoint nearest_within(const BlobView& view, Vec3 probe, float r);

struct PointsWithin {
  std::uint32_t count = 0;  ///< how many indices were written
  bool complete = true;     ///< false: the buffer was too small for all of them
};

/// All points with distance <= r from `probe`, their indices into `out` in no particular order.
/// A buffer of header().points_per_ball_max entries is always enough for r <= reach_m().
[[nodiscard]] PointsWithin points_within(const BlobView& view, Vec3 probe, float r,
                                         std::span<std::uint32_t> out);

/// Is `probe` in the axis-aligned box, edge header().aabb_edge_m, of any point? Exact, closed
/// boxes. Precondition: aabb_edge_m / 2 <= reach_m(), which holds in every `surface` blob; else
/// false.
[[nodiscard]] bool in_any_vertex_box(const BlobView& view, Vec3 probe);

}  // namespace tactree::core
