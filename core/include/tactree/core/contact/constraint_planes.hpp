#pragma once
// Up to three planes that hold a point on their front side, and the shortest move of the point to
// the region in front of all of them. (The constraints of Zilles and Salisbury, "A constraint-based
// god-object method for haptic display", IROS 1995, in closed form: at most three planes meet in a
// point.)
//
// Interrupt safety: pure functions. Cost: at most about 200 operations.

#include <cstdint>

#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kMaxFaces = 3;

/// Three planes have no common point if the determinant of their normals is at most this.
inline constexpr float kNoCommonPoint = 1e-3F;

/// A plane relative to a position. By default the position is far in front, so that the plane has
/// no effect.
struct Plane {
  Vec3 normal{};           ///< unit length
  float distance = 1e30F;  ///< m, of the position; positive in front
};

struct ConstraintPlanes {
  Plane plane[kMaxFaces]{};
  std::uint32_t count = 0;  ///< the planes from `count` on must be Plane{}

  /// Moves the position by `step` (m).
  void step_by(Vec3 step);
};

struct PlaneMove {
  Vec3 step{};               ///< m
  std::uint32_t active = 0;  ///< bit i: the step ends on plane i, which holds the point back
};

/// The shortest step that ends in front of all planes, and on the first one if `onto_first`. If no
/// such step exists because planes are parallel, returns the step onto the plane with the largest
/// violation, or onto the first plane if `onto_first`.
[[nodiscard]] PlaneMove shortest_move(const ConstraintPlanes& planes, bool onto_first);

}  // namespace tactree::core
