// Three arms on a ring. For leg i, in the ring's frame rotated by the leg's angle, with u outwards,
// v along the joint and w normal to the ring:
//   du = u - r + c - a cos(q_i),  dv = v - s + f,  dw = w - a sin(q_i)
//   g  = |(du, dw)| - (d + e)
//   g^2 + dv^2 = b^2                                                     (closure)
// n_i = (g du / (g + d + e), dv, g dw / (g + d + e)) is the parallelogram's long side, hence
//   n_i . dP = h_i dq_i,   h_i = a g (dw cos(q_i) - du sin(q_i)) / (g + d + e)
// and row i of the transposed Jacobian is h_i (n_j x n_k) / det(n_0, n_1, n_2), derived from the
// closure.
// Frame of the ring: w is the x axis of the device; the leg angle 0 points along y, a quarter turn
// along z.
//
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "kinds.hpp"
#include "tactree/core/math/sine.hpp"

namespace tactree::core {
namespace {

// Within the joint ranges of the falcon preset, the three steps are at most 22 mm, 2.7 mm and 39 um
// long. After two of them up to 39 um of error remain, after three only that of rounding.
constexpr std::uint32_t kNewtonSteps = 3;
// If the last Newton step is longer, the closure equations have no solution. A limit of 20 um made
// poses at the ends of the ranges invalid, which is a fault. After a last step of 0.5 mm the error
// is about 1 um.
constexpr float kConverged = 5e-4F;  // m

/// The constants of a leg during the Newton iteration for the plate.
struct Leg {
  Vec3 out;        // u
  Vec3 along;      // v
  Vec3 fixed;      // (du, dv, dw) = plate - fixed
  SineCosine arm;  // of the joint angle
};

constexpr Vec3 kRingNormal = {1.0F, 0.0F, 0.0F};  // w

Leg leg_of(const DeltaGeometry& g, float place_rad, float joint_rad) {
  const SineCosine place = sine_cosine(place_rad);
  const SineCosine arm = sine_cosine(joint_rad);
  const Vec3 out = {0.0F, place.cosine, place.sine};
  const Vec3 along = {0.0F, -place.sine, place.cosine};
  return {out, along,
          (g.r - g.c + g.a * arm.cosine) * out + (g.s - g.f) * along + g.a * arm.sine * kRingNormal,
          arm};
}

/// One closure and its gradient.
struct Closure {
  float residual;  // half of g^2 + dv^2 - b^2
  Vec3 n;
  float h;
  bool open;  // the parallelogram is extended, not folded back
};

Closure close(const DeltaGeometry& g, const Leg& leg, Vec3 plate) {
  const Vec3 from_leg = plate - leg.fixed;
  const float du = dot(from_leg, leg.out);
  const float dv = dot(from_leg, leg.along);
  const float dw = dot(from_leg, kRingNormal);
  const float reach = square_root(du * du + dw * dw);
  const float stretch = reach - (g.d + g.e);
  const bool open = stretch > 0.0F;
  const float share = open ? stretch / reach : 0.0F;
  return {0.5F * (stretch * stretch + dv * dv - g.b * g.b),
          share * du * leg.out + dv * leg.along + share * dw * kRingNormal,
          share * g.a * (dw * leg.arm.cosine - du * leg.arm.sine), open};
}

/// The three closures, and the inverse of the matrix of their gradients.
struct Closures {
  Closure of[kAxes];
  Vec3 column[kAxes];  // of the inverse of the matrix with rows n
  float openness;      // volume spanned by the three unit vectors n / b
  bool valid;
};

Closures close_all(const DeltaGeometry& g, const Leg (&legs)[kAxes], Vec3 plate) {
  const Closure first = close(g, legs[0], plate);
  const Closure second = close(g, legs[1], plate);
  const Closure third = close(g, legs[2], plate);
  const Vec3 n0 = first.n;
  const Vec3 n1 = second.n;
  const Vec3 n2 = third.n;
  const Vec3 across = cross(n1, n2);
  const float volume = dot(n0, across);
  const float openness = absolute(volume) / (g.b * g.b * g.b);
  const bool valid = first.open && second.open && third.open && openness > 1e-4F;
  const float inverse = valid ? 1.0F / volume : 0.0F;
  return {{first, second, third},
          {inverse * across, inverse * cross(n2, n0), inverse * cross(n0, n1)},
          openness,
          valid};
}

/// Initial guess of the plate, within 22 mm for the falcon preset: the intersection, on the +x side
/// of the ring, of three spheres with the maximum length of a leg as radius. Returns false if they
/// do not intersect.
bool first_guess(const DeltaGeometry& g, const Leg (&legs)[kAxes], Vec3& plate) {
  const Vec3 a = legs[1].fixed - legs[0].fixed;
  const Vec3 b = legs[2].fixed - legs[0].fixed;
  const Vec3 normal = cross(a, b);
  const float squared = length_squared(normal);
  if (!(squared > 1e-12F)) {
    return false;
  }
  const Vec3 centre = (0.5F / squared) *
                      (length_squared(b) * cross(normal, a) + length_squared(a) * cross(b, normal));
  const float longest = g.b + g.d + g.e;
  const float height_squared = longest * longest - length_squared(centre);
  if (!(height_squared > 0.0F)) {
    return false;
  }
  const float height = square_root(height_squared / squared);
  plate = legs[0].fixed + centre + (normal.x < 0.0F ? -height : height) * normal;
  return true;
}

/// Computes the Jacobian, and the efforts that hold the weight of the legs, at the solution.
[[gnu::noinline]] void finish(const DeviceModel& device, const Leg (&legs)[kAxes],
                              const Closures& all, KindPose& pose) {
  pose.openness = all.openness;
  float link_effort[kAxes];
  for (std::uint32_t i = 0; i < kAxes; ++i) {  // bound: kAxes
    pose.effort_per_force.row[i] = all.of[i].h * all.column[i];
    // From the height of the arm's centre of mass: centre * cos(q) * sin(leg angle).
    link_effort[i] = -kGravity * device.link_mass_kg[i] * device.link_centre_m[i] *
                     legs[i].arm.sine * legs[i].out.z;
  }
  pose.link_effort = {link_effort[0], link_effort[1], link_effort[2]};
}

}  // namespace

KindPose locate_delta(const DeviceModel& device, Vec3 joints) {
  const DeltaGeometry& g = device.delta;
  const Leg legs[kAxes] = {leg_of(g, g.leg_rad[0], joints.x), leg_of(g, g.leg_rad[1], joints.y),
                           leg_of(g, g.leg_rad[2], joints.z)};
  KindPose pose;
  if (!first_guess(g, legs, pose.probe)) {
    return pose;
  }
  Vec3 step{};
  for (std::uint32_t i = 0; i <= kNewtonSteps; ++i) {  // bound: kNewtonSteps + 1
    const Closures all = close_all(g, legs, pose.probe);
    if (!all.valid) {
      return pose;
    }
    if (i == kNewtonSteps) {
      finish(device, legs, all, pose);  // at most: 1 per locate_delta
      pose.valid = length_squared(step) <= kConverged * kConverged;
      return pose;
    }
    step = all.of[0].residual * all.column[0] + all.of[1].residual * all.column[1] +
           all.of[2].residual * all.column[2];
    pose.probe -= step;
  }
  return pose;
}

}  // namespace tactree::core
