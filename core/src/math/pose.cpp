// Validity, normalisation and integration of poses.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/math/pose.hpp"

namespace tactree::core {
namespace {

// Returns false for NaN and infinity.
bool within(Vec3 v, float limit) {
  return absolute(v.x) <= limit && absolute(v.y) <= limit && absolute(v.z) <= limit;
}

float length_squared(Quaternion q) { return q.w * q.w + core::length_squared(q.v); }

Quaternion unit(Quaternion q) {
  const float scale = 1.0F / square_root(length_squared(q));
  return {scale * q.w, scale * q.v};
}

}  // namespace

Vec3 rotate(Quaternion q, Vec3 direction) {
  const Vec3 t = 2.0F * cross(q.v, direction);
  return direction + q.w * t + cross(q.v, t);
}

bool is_valid(const Pose& pose) {
  return within(pose.translation_m, kMaxTranslation) &&
         absolute(length_squared(pose.rotation) - 1.0F) <= kQuaternionTolerance;
}

bool is_valid(const Motion& motion) {
  return within(motion.linear_m_s, kMaxBodySpeed) && within(motion.angular_rad_s, kMaxBodyTurn);
}

Pose normalized(const Pose& pose) {
  const bool already = length_squared(pose.rotation) == 1.0F;
  return already ? pose : Pose{unit(pose.rotation), pose.translation_m};
}

Pose advanced(const Pose& pose, const Motion& motion, float seconds) {
  if (is_rest(motion)) {
    return pose;
  }
  const Quaternion& q = pose.rotation;
  const Vec3 half_turn = (0.5F * seconds) * motion.angular_rad_s;
  Pose next;
  next.rotation = unit({q.w - dot(half_turn, q.v), q.v + q.w * half_turn + cross(half_turn, q.v)});
  next.translation_m = pose.translation_m + seconds * motion.linear_m_s;
  if (!within(next.translation_m, kMaxTranslation)) {
    next.translation_m = pose.translation_m;
  }
  return next;
}

}  // namespace tactree::core
