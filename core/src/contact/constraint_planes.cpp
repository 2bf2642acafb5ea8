// Closed forms of the shortest move onto one, two or three planes, and the selection among them.
// The sets of planes are compared by the distances and the cosines between the normals alone.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/constraint_planes.hpp"

namespace tactree::core {
namespace {

// A point behind a plane by less than this, m, counts as on it: several rounding errors of
// coordinates below 1 m.
constexpr float kOnPlane = 2e-7F;

// Two planes count as parallel if the squared sine of their angle is at most kParallel (1.8
// degrees). Like the determinant of kNoCommonPoint, it is a difference of products of about 1, with
// rounding errors of about 1e-7: below 1e-3 the step would be wrong by more than 1e-4 of its
// length, and up to 32 times (two planes) or 1000 times (three) as long as the distances of the
// planes.
constexpr float kParallel = 1e-3F;

constexpr std::uint32_t kFirst = 1;
constexpr std::uint32_t kSecond = 2;
constexpr std::uint32_t kThird = 4;

/// A step onto two planes, along their normals.
struct OntoTwo {
  bool allowed = false;
  float by_a = 0.0F;  // m
  float by_b = 0.0F;
};

/// The step onto planes a and b. `a`, `b`, `c`: distances of the three planes; `ab`, `bc`, `ca`:
/// cosines between their normals. Not allowed if a and b are parallel, if one of them does not hold
/// the point back and need not be reached (`a_on`, `b_on`), or if the step ends behind c.
OntoTwo onto_two(float a, float b, float c, float ab, float bc, float ca, bool a_on, bool b_on) {
  OntoTwo step;
  const float sine_squared = 1.0F - ab * ab;
  if (!(sine_squared > kParallel)) {
    return step;
  }
  const float inverse = 1.0F / sine_squared;
  step.by_a = inverse * (ab * b - a);
  step.by_b = inverse * (ab * a - b);
  step.allowed = (a_on || step.by_a >= 0.0F) && (b_on || step.by_b >= 0.0F) &&
                 c + step.by_a * ca + step.by_b * bc >= -kOnPlane;
  return step;
}

Vec3 along(const OntoTwo& step, const Plane& a, const Plane& b) {
  return step.by_a * a.normal + step.by_b * b.normal;
}

}  // namespace

void ConstraintPlanes::step_by(Vec3 step) {
  for (std::uint32_t i = 0; i < count; ++i) {  // bound: kMaxFaces
    plane[i].distance += dot(plane[i].normal, step);
  }
}

// Tries the sets of planes in ascending order of size. The first allowed step is the shortest,
// since the planes of its set hold the point back and the others do not.
PlaneMove shortest_move(const ConstraintPlanes& planes, bool onto_first) {
  const Plane& first = planes.plane[0];
  const Plane& second = planes.plane[1];
  const Plane& third = planes.plane[2];
  const float a = first.distance;
  const float b = second.distance;
  const float c = third.distance;
  if (!onto_first && a >= -kOnPlane && b >= -kOnPlane && c >= -kOnPlane) {
    return {};
  }
  const float ab = dot(first.normal, second.normal);
  const float bc = dot(second.normal, third.normal);
  const float ca = dot(third.normal, first.normal);
  if ((onto_first || a < 0.0F) && b - a * ab >= -kOnPlane && c - a * ca >= -kOnPlane) {
    return {-a * first.normal, kFirst};
  }
  if (!onto_first && b < 0.0F && a - b * ab >= -kOnPlane && c - b * bc >= -kOnPlane) {
    return {-b * second.normal, kSecond};
  }
  if (!onto_first && c < 0.0F && a - c * ca >= -kOnPlane && b - c * bc >= -kOnPlane) {
    return {-c * third.normal, kThird};
  }
  if (planes.count > 1U) {
    const OntoTwo step = onto_two(a, b, c, ab, bc, ca, onto_first, false);
    if (step.allowed) {
      return {along(step, first, second), kFirst | kSecond};
    }
  }
  if (planes.count > 2U) {
    OntoTwo step = onto_two(c, a, b, ca, ab, bc, false, onto_first);
    if (step.allowed) {
      return {along(step, third, first), kThird | kFirst};
    }
    step = onto_two(b, c, a, bc, ca, ab, false, false);
    if (!onto_first && step.allowed) {
      return {along(step, second, third), kSecond | kThird};
    }
    const Vec3 across = cross(second.normal, third.normal);
    const float determinant = dot(first.normal, across);
    if (absolute(determinant) > kNoCommonPoint) {
      const Vec3 sum = a * across + b * cross(third.normal, first.normal) +
                       c * cross(first.normal, second.normal);
      return {(-1.0F / determinant) * sum, kFirst | kSecond | kThird};
    }
  }
  if (onto_first || (a <= b && a <= c)) {
    return {-a * first.normal, kFirst};
  }
  return b <= c ? PlaneMove{-b * second.normal, kSecond} : PlaneMove{-c * third.normal, kThird};
}

}  // namespace tactree::core
