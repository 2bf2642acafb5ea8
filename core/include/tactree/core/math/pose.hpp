#pragma once
// Pose and motion of a rigid body in the scene frame.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// Unit quaternion.
struct Quaternion {
  float w = 1.0F;
  Vec3 v{};
  friend constexpr bool operator==(Quaternion, Quaternion) = default;
};

/// Rotates a direction from the body frame to the scene frame. About 30 operations.
[[nodiscard]] Vec3 rotate(Quaternion q, Vec3 direction);
/// Rotates a direction from the scene frame to the body frame.
[[nodiscard]] inline Vec3 rotate_back(Quaternion q, Vec3 direction) {
  return rotate({q.w, -q.v}, direction);
}

/// scene position = rotation * body position + translation
struct Pose {
  Quaternion rotation{};
  Vec3 translation_m{};
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

/// Linear velocity of the body's origin and angular velocity of the body, in the scene frame.
struct Motion {
  Vec3 linear_m_s{};
  Vec3 angular_rad_s{};
  friend constexpr bool operator==(const Motion&, const Motion&) = default;
};

/// m, of each component. Float32 resolves 1 um there.
inline constexpr float kMaxTranslation = 10.0F;
/// m/s, of each component: the default of speed_max_m_s. A probe and a body that meet at this speed
/// have twice the speed relative to each other, the limit of Scene between motion and jump.
inline constexpr float kMaxBodySpeed = 10.0F;
/// rad/s, of each component: 0.1 rad per tick at 1 kHz, where advanced() lags by 1e-4 rad (a
/// twelfth of the cube of the angle).
inline constexpr float kMaxBodyTurn = 100.0F;
/// Deviation of the squared length from 1. Components with four decimals deviate by up to 2e-4; one
/// that deviates by more than the tolerance is not a rounded rotation.
inline constexpr float kQuaternionTolerance = 1.0e-3F;

/// True if all values are finite and within the limits above. The squared length of a pose's
/// quaternion must be 1 within kQuaternionTolerance.
[[nodiscard]] bool is_valid(const Pose& pose);
[[nodiscard]] bool is_valid(const Motion& motion);

/// The pose with its rotation normalised. Precondition: is_valid(pose).
[[nodiscard]] Pose normalized(const Pose& pose);

/// The pose after `seconds`, to first order in the rotation: at 10 rad/s and 1 kHz the error of a
/// tick is below 1e-7 rad. A motion beyond kMaxTranslation leaves the translation unchanged.
[[nodiscard]] Pose advanced(const Pose& pose, const Motion& motion, float seconds);

/// True if the body frame equals the scene frame.
[[nodiscard]] constexpr bool is_origin(const Pose& pose) {
  return pose.rotation.w == 1.0F && pose.rotation.v == Vec3{} && pose.translation_m == Vec3{};
}
[[nodiscard]] constexpr bool is_rest(const Motion& motion) {
  return motion.linear_m_s == Vec3{} && motion.angular_rad_s == Vec3{};
}

// For an identity pose or a body at rest, these functions return their argument bit-identical.

[[nodiscard]] inline Vec3 position_to_body(const Pose& pose, Vec3 position) {
  return is_origin(pose) ? position : rotate_back(pose.rotation, position - pose.translation_m);
}
[[nodiscard]] inline Vec3 position_to_scene(const Pose& pose, Vec3 position) {
  return is_origin(pose) ? position : rotate(pose.rotation, position) + pose.translation_m;
}
[[nodiscard]] inline Vec3 direction_to_body(const Pose& pose, Vec3 direction) {
  return is_origin(pose) ? direction : rotate_back(pose.rotation, direction);
}

/// Velocity, relative to the body, of a point at `position` that moves with `velocity`. All vectors
/// are in the scene frame.
[[nodiscard]] inline Vec3 relative_velocity(const Pose& pose, const Motion& motion, Vec3 position,
                                            Vec3 velocity) {
  if (is_rest(motion)) {
    return velocity;
  }
  return velocity - motion.linear_m_s - cross(motion.angular_rad_s, position - pose.translation_m);
}

}  // namespace tactree::core
