#pragma once
// Where a rigid body is and how it moves, as seen from the scene. Interrupt safe: pure functions.

#include <cstdint>

#include "tactree/core/vec3.hpp"

namespace tactree::core {

/// Of unit length.
struct Quaternion {
  float w = 1.0F;
  Vec3 v{};
  friend constexpr bool operator==(Quaternion, Quaternion) = default;
};

/// Turns a direction of the body into one of the scene. About 30 operations.
constexpr Vec3 rotate(Quaternion q, Vec3 direction) {
  const Vec3 t = 2.0F * cross(q.v, direction);
  return direction + q.w * t + cross(q.v, t);
}
/// And back.
constexpr Vec3 rotate_back(Quaternion q, Vec3 direction) { return rotate({q.w, -q.v}, direction); }

/// scene position = rotation * body position + translation
struct Pose {
  Quaternion rotation{};
  Vec3 translation_m{};
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

/// Of the body's origin, along and about the scene's axes.
struct Motion {
  Vec3 linear_m_s{};
  Vec3 angular_rad_s{};
  friend constexpr bool operator==(const Motion&, const Motion&) = default;
};

inline constexpr float kMaxTranslation = 10.0F;         ///< m, of each component
inline constexpr float kMaxBodySpeed = 10.0F;           ///< m/s, of each component
inline constexpr float kMaxBodyTurn = 100.0F;           ///< rad/s, of each component
inline constexpr float kQuaternionTolerance = 1.0e-3F;  ///< of the squared length from 1

/// Finite, of unit length within the tolerance, and within the limits?
[[nodiscard]] bool is_valid(const Pose& pose);
[[nodiscard]] bool is_valid(const Motion& motion);

/// The pose with its rotation made as unit as float32 allows. Precondition: is_valid(pose).
[[nodiscard]] Pose normalized(const Pose& pose);

/// Where the body is after `seconds`, to first order in the turn: at 10 rad/s and 1 kHz it errs by
/// less than 1e-7 rad. At kMaxTranslation the body stays where it is.
[[nodiscard]] Pose advanced(const Pose& pose, const Motion& motion, float seconds);

// At the identity, positions, directions and velocities keep their very bits.

[[nodiscard]] inline Vec3 position_to_body(const Pose& pose, Vec3 position) {
  return pose == Pose{} ? position : rotate_back(pose.rotation, position - pose.translation_m);
}
[[nodiscard]] inline Vec3 position_to_scene(const Pose& pose, Vec3 position) {
  return pose == Pose{} ? position : rotate(pose.rotation, position) + pose.translation_m;
}
[[nodiscard]] inline Vec3 direction_to_body(const Pose& pose, Vec3 direction) {
  return pose == Pose{} ? direction : rotate_back(pose.rotation, direction);
}
[[nodiscard]] inline Vec3 direction_to_scene(const Pose& pose, Vec3 direction) {
  return pose == Pose{} ? direction : rotate(pose.rotation, direction);
}

/// Of something at `position` that moves with `velocity`, as seen from the body; scene's axes.
[[nodiscard]] inline Vec3 relative_velocity(const Pose& pose, const Motion& motion, Vec3 position,
                                            Vec3 velocity) {
  if (motion == Motion{}) {
    return velocity;
  }
  return velocity - motion.linear_m_s - cross(motion.angular_rad_s, position - pose.translation_m);
}

}  // namespace tactree::core
