// Conversion of encoder counts to joints, and the limits common to all kinds of device.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/device/kinematics.hpp"

#include "kinds.hpp"

namespace tactree::core {
namespace {

constexpr Mat3 kIdentity{{{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}, {0.0F, 0.0F, 1.0F}}};

// Limits of KindPose::openness. Up to kSingular the force is zero, because the position of a
// parallel linkage is inaccurate there and small forces require large efforts: both grow as 1 /
// openness, to 20 times at kSingular and 7 times at kOpen, from which on the full force is allowed.
// The delta preset stays above 0.13 within its joint ranges; a larger kOpen would weaken it there.
// If the limits were closer to each other, the force would end within less motion than 5.7 degrees
// of an elbow.
constexpr float kSingular = 0.05F;
constexpr float kOpen = 0.15F;

constexpr float lower(float a, float b) { return a < b ? a : b; }

/// Position of one joint; the counter may have wrapped around.
float joint_of(const DeviceModel& device, std::uint32_t axis, std::int32_t count) {
  const std::uint32_t difference =
      static_cast<std::uint32_t>(count) - static_cast<std::uint32_t>(device.home_count[axis]);
  return device.home_position[axis] +
         static_cast<float>(static_cast<std::int32_t>(difference)) / counts_per_unit(device, axis);
}

/// Fraction of the force that the range of one joint allows; negative if it is out of range.
float share_of_range(const DeviceModel& device, std::uint32_t axis, float joint) {
  const float margin = device.joint_margin[axis];
  const float inside = lower(joint - device.joint_min[axis], device.joint_max[axis] - joint);
  if (inside >= margin) {
    return 1.0F;
  }
  if (!(inside >= -margin)) {
    return -1.0F;
  }
  return inside > 0.0F ? inside / margin : 0.0F;
}

float share_of_ranges(const DeviceModel& device, Vec3 joints) {
  const float all[kAxes] = {joints.x, joints.y, joints.z};
  const std::uint32_t axes = axes_of(device.kind);
  float share = 1.0F;
  for (std::uint32_t i = 0; i < axes; ++i) {  // bound: kAxes
    share = lower(share, share_of_range(device, i, all[i]));
  }
  return share;
}

DevicePose nowhere(Vec3 joints) {
  DevicePose pose;
  pose.joints = joints;
  return pose;
}

KindPose locate_kind(const DeviceModel& device, Vec3 joints) {
  if (device.kind == DeviceKind::kCartesian) {
    return {true, joints, kIdentity, {}, 1.0F};
  }
  if (device.kind == DeviceKind::kArm) {
    return locate_arm(device, joints);
  }
  if (device.kind == DeviceKind::kDelta) {
    return locate_delta(device, joints);  // at most: delta per locate_joints
  }
  if (device.kind == DeviceKind::kFiveBar) {
    return locate_five_bar(device, joints);
  }
  return device.kind == DeviceKind::kPaddle ? locate_paddle(device, joints) : KindPose{};
}

}  // namespace

Mat3 force_per_effort(const Mat3& effort_per_force) {
  const Vec3 first = effort_per_force.row[0];
  const Vec3 second = effort_per_force.row[1];
  const Vec3 third = effort_per_force.row[2];
  const bool planar = third == Vec3{};
  if (planar && second == Vec3{}) {
    return {{(1.0F / length_squared(first)) * first, {}, {}}};
  }
  const Vec3 normal = cross(first, second);
  const Vec3 last = planar ? normal : third;
  const Vec3 across = cross(second, last);
  const float scale = 1.0F / dot(first, across);
  return {{scale * across, scale * cross(last, first), planar ? Vec3{} : scale * normal}};
}

Vec3 joints_of(const DeviceModel& device, const std::int32_t (&counts)[kAxes]) {
  const std::uint32_t axes = axes_of(device.kind);
  return {joint_of(device, 0, counts[0]), axes > 1 ? joint_of(device, 1, counts[1]) : 0.0F,
          axes > 2 ? joint_of(device, 2, counts[2]) : 0.0F};
}

DevicePose locate_joints(const DeviceModel& device, Vec3 joints) {
  const float share = share_of_ranges(device, joints);
  if (!(share >= 0.0F)) {
    return nowhere(joints);
  }
  const KindPose place = locate_kind(device, joints);
  if (!place.valid || !is_finite(place.probe)) {
    return nowhere(joints);
  }
  const float open = place.openness > kSingular
                         ? lower(1.0F, (place.openness - kSingular) / (kOpen - kSingular))
                         : 0.0F;
  const Vec3 tip_weight = {0.0F, 0.0F, kGravity * device.tip_mass_kg};
  return {true,
          lower(share, open),
          joints,
          place.probe - device.origin_m,
          place.effort_per_force,
          place.link_effort + place.effort_per_force * tip_weight};
}

DevicePose locate(const DeviceModel& device, const std::int32_t (&counts)[kAxes]) {
  return locate_joints(device, joints_of(device, counts));
}

}  // namespace tactree::core
