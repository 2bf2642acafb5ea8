#pragma once
// Up to three planes that hold a point on their front side, and the shortest move to the place
// where it may be. (The constraints of Zilles and Salisbury, "A constraint-based god-object method
// for haptic display", IROS 1995, in closed form: at most three planes meet in a point.)
//
// Interrupt safety: pure functions. Cost: at most about 200 operations.

#include <cstdint>

#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kMaxFaces = 3;

/// A plane near a place. Initially there is none: the place is far in front of it.
struct Plane {
  Vec3 normal{};           ///< unit length
  float distance = 1e30F;  ///< m, of the place, positive in front
};

struct ConstraintPlanes {
  Plane plane[kMaxFaces]{};
  std::uint32_t count = 0;  ///< those behind it are none

  /// The same planes, seen from a place that is further by `step` (m).
  void step_by(Vec3 step);
};

struct PlaneMove {
  Vec3 step{};               ///< m
  std::uint32_t active = 0;  ///< bit i: the step ends on plane i, which holds the point back
};

/// The shortest step that ends in front of all planes, and on the first one if `onto_first`. If
/// there is none, the planes being parallel: the step onto the plane that is violated most, or onto
/// the first one.
[[nodiscard]] PlaneMove shortest_move(const ConstraintPlanes& planes, bool onto_first);

}  // namespace tactree::core
