// One lever in the plane x-z.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "kinds.hpp"
#include "tactree/core/math/sine.hpp"

namespace tactree::core {

KindPose locate_paddle(const DeviceModel& device, Vec3 joints) {
  const SineCosine lever = sine_cosine(joints.x);
  KindPose pose;
  pose.valid = true;
  pose.probe = device.paddle_m * Vec3{lever.cosine, 0.0F, lever.sine};
  pose.effort_per_force.row[0] = device.paddle_m * Vec3{-lever.sine, 0.0F, lever.cosine};
  pose.link_effort.x = kGravity * device.link_mass_kg[0] * device.link_centre_m[0] * lever.cosine;
  return pose;
}

}  // namespace tactree::core
