// Two arms on motors and two forearms that meet at the probe, in the plane y-z. With the probe P,
// the elbow E_i and the forearm n_i = P - E_i of a fixed length:
//   n_i . dP = n_i . dE_i,  so row i of the transposed Jacobian is (n_i . dE_i / dq_i) times
//   column i of the inverse of (n_0, n_1).
//
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "kinds.hpp"
#include "tactree/core/math/sine.hpp"

namespace tactree::core {
namespace {

constexpr Vec3 in_plane(float y, float z) { return {0.0F, y, z}; }
/// Rotates `v` by a quarter turn from y towards z.
constexpr Vec3 turned(Vec3 v) { return {0.0F, -v.z, v.y}; }

}  // namespace

KindPose locate_five_bar(const DeviceModel& device, Vec3 joints) {
  const FiveBarGeometry& g = device.five_bar;
  const SineCosine first = sine_cosine(joints.x);
  const SineCosine second = sine_cosine(joints.y);
  const Vec3 arm0 = g.arm_m * in_plane(first.cosine, first.sine);
  const Vec3 arm1 = g.arm_m * in_plane(second.cosine, second.sine);
  const Vec3 elbow0 = in_plane(-0.5F * g.base_m, 0.0F) + arm0;
  const Vec3 elbow1 = in_plane(0.5F * g.base_m, 0.0F) + arm1;

  const Vec3 half = 0.5F * (elbow1 - elbow0);
  const float half_squared = length_squared(half);
  const float rise_squared = g.forearm_m * g.forearm_m - half_squared;
  if (!(rise_squared > 0.0F && half_squared > 1e-12F)) {
    return {};  // the elbows are too far apart, or coincide
  }
  const Vec3 rise = square_root(rise_squared / half_squared) * turned(half);
  const Vec3 probe = elbow0 + half + rise;

  const Vec3 n0 = probe - elbow0;
  const Vec3 n1 = probe - elbow1;
  const float area = dot(turned(n0), n1);
  const float openness = absolute(area) / (g.forearm_m * g.forearm_m);
  if (!(openness > 1e-4F)) {
    return {};
  }
  return {true,
          probe,
          {{(-dot(n0, turned(arm0)) / area) * turned(n1),
            (dot(n1, turned(arm1)) / area) * turned(n0),
            {}}},
          {kGravity * device.link_mass_kg[0] * device.link_centre_m[0] * first.cosine,
           kGravity * device.link_mass_kg[1] * device.link_centre_m[1] * second.cosine, 0.0F},
          openness};
}

}  // namespace tactree::core
