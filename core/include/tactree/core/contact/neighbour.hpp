#pragma once
// Another body near a proxy. Where bodies touch or overlap, the probe feels the surface of all of
// them together: one proxy is held by the faces of each, and faces of one within another are none.
//
// Interrupt safety: pure functions.

#include <cstdint>

#include "tactree/core/contact/constraint_planes.hpp"
#include "tactree/core/math/pose.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// Of a neighbour: what is in front of it has a positive height.
struct NeighbourFace {
  Vec3 normal{};          ///< unit length
  float offset_m = 0.0F;  ///< from the frame's origin

  [[nodiscard]] float height_of(Vec3 x) const { return dot(normal, x) - offset_m; }
};

/// In the frame of the body whose proxy it concerns.
struct Neighbour {
  /// First those that hold a proxy, then those behind which the others end, all seen from its side.
  NeighbourFace face[kMaxFaces]{};
  std::uint32_t holding = 0;  ///< 0: no surface is near, and there are no faces
  std::uint32_t ending = 0;
  Vec3 found_at{};           ///< m, where its faces were found
  bool holds = false;        ///< false: it has no surface near its proxy any more
  float tolerance_m = 0.0F;  ///< faces that are closer to each other are flush
  bool leads = false;        ///< its proxy is in contact
  Vec3 proxy{};              ///< m

  /// Adds the faces that hold a proxy, as seen from `x`, except those that continue one of the
  /// planes. Where there is no room, one takes the place of a plane further away, but not of the
  /// first one. Returns a bit for each plane added.
  [[nodiscard]] std::uint32_t add_to(ConstraintPlanes& planes, Vec3 x) const;
  /// From the frame of a body at `from` to that of one at `to`.
  void bring(const Pose& from, const Pose& to);

 private:
  [[nodiscard]] bool continues(const ConstraintPlanes& planes, const Plane& plane) const;
};

}  // namespace tactree::core
