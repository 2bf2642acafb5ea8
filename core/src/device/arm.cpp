// A rotating base, an arm and a forearm. With a parallelogram (coupling 0): M. C. Cavusoglu,
// D. Feygin and F. Tendick, "A critical study of the mechanical and electrical properties of the
// PHANToM haptic interface", Presence 11(6), 2002, section 2.
//
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "kinds.hpp"
#include "tactree/core/math/sine.hpp"

namespace tactree::core {

KindPose locate_arm(const DeviceModel& device, Vec3 joints) {
  const ArmGeometry& g = device.arm;
  const SineCosine base = sine_cosine(joints.x);
  const SineCosine arm = sine_cosine(joints.y);
  const SineCosine forearm = sine_cosine(joints.z + g.coupling * joints.y);
  const float radius = g.arm_m * arm.cosine + g.forearm_m * forearm.sine;
  const float height = g.arm_m * arm.sine - g.forearm_m * forearm.cosine;
  const Vec3 outwards = {base.cosine, base.sine, 0.0F};
  const Vec3 up = {0.0F, 0.0F, 1.0F};
  const auto in_plane = [&](float out, float z) { return out * outwards + z * up; };

  const Vec3 by_forearm = in_plane(g.forearm_m * forearm.cosine, g.forearm_m * forearm.sine);
  const Vec3 by_arm = in_plane(-g.arm_m * arm.sine, g.arm_m * arm.cosine);
  const Vec3 by_base = radius * Vec3{-base.sine, base.cosine, 0.0F};

  // Singular poses: elbow extended or folded, and probe on the axis of the base.
  const float elbow = arm.cosine * forearm.cosine + arm.sine * forearm.sine;
  const float stand_off = radius / (g.arm_m + g.forearm_m);
  const float openness = elbow < stand_off ? elbow : stand_off;

  const float forearm_weight = kGravity * device.link_mass_kg[2];
  const float arm_lever =
      kGravity * device.link_mass_kg[1] * device.link_centre_m[1] + forearm_weight * g.arm_m;
  const float forearm_effort = forearm_weight * device.link_centre_m[2] * forearm.sine;
  const Vec3 link_effort = {0.0F, arm_lever * arm.cosine + g.coupling * forearm_effort,
                            forearm_effort};
  return {true,
          in_plane(radius, height),
          {{by_base, by_arm + g.coupling * by_forearm, by_forearm}},
          link_effort,
          openness};
}

}  // namespace tactree::core
