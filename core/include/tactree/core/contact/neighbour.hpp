#pragma once
// Another body near a proxy. Where bodies touch or overlap, the probe feels the surface of their
// union: one proxy is held by the faces of all bodies, and faces of one body inside another are
// ignored.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/contact/constraint_planes.hpp"
#include "tactree/core/math/pose.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// A face of a neighbour. Positions in front of it have a positive height.
struct NeighbourFace {
  Vec3 normal{};          ///< unit length
  float offset_m = 0.0F;  ///< of the plane from the frame's origin, along the normal

  [[nodiscard]] float height_of(Vec3 x) const { return dot(normal, x) - offset_m; }
};

/// The other body near a proxy, in the frame of the body whose proxy it affects. "Its proxy" below
/// means the proxy of this other body.
struct Neighbour {
  /// First the `holding` faces, then the `ending` faces, whose planes bound the others. All normals
  /// point to the side of its proxy.
  NeighbourFace face[kMaxFaces]{};
  std::uint32_t holding = 0;  ///< 0: no surface is near; face[] is not valid
  std::uint32_t ending = 0;
  Vec3 found_at{};           ///< m, position of its proxy when the faces were found
  bool holds = false;        ///< false: there is no longer a surface near its proxy
  float tolerance_m = 0.0F;  ///< faces that are closer to each other are flush
  bool leads = false;        ///< its proxy is in contact
  Vec3 proxy{};              ///< m

  /// Adds the `holding` faces with their distances from `x`, except those that continue one of the
  /// planes. If there is no room, a face replaces the more distant of the second and third plane if
  /// it is closer than that plane. Returns a mask: bit i is set if plane i was added.
  [[nodiscard]] std::uint32_t add_to(ConstraintPlanes& planes, Vec3 x) const;
  /// Transforms it from the frame of a body at `from` to the frame of a body at `to`.
  void bring(const Pose& from, const Pose& to);

 private:
  [[nodiscard]] bool continues(const ConstraintPlanes& planes, const Plane& plane) const;
};

}  // namespace tactree::core
