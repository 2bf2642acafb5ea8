// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/neighbour.hpp"

namespace tactree::core {
namespace {

// Normals of faces that continue each other differ by less than 8 degrees. Without this limit,
// flush faces of two bodies would hold the proxy by two nearly parallel planes.
constexpr float kContinuing = 0.99F;

}  // namespace

bool Neighbour::continues(const ConstraintPlanes& planes, const Plane& plane) const {
  bool found = false;
  for (std::uint32_t i = 0; i < planes.count; ++i) {  // bound: kMaxFaces
    const Plane& other = planes.plane[i];
    found = found || (dot(plane.normal, other.normal) > kContinuing &&
                      absolute(plane.distance - other.distance) <= tolerance_m);
  }
  return found;
}

[[gnu::noinline]] std::uint32_t Neighbour::add_to(ConstraintPlanes& planes, Vec3 x) const {
  std::uint32_t added = 0;
  for (std::uint32_t i = 0; holds && i < holding; ++i) {  // bound: kMaxFaces
    const Plane plane{face[i].normal, face[i].height_of(x)};
    std::uint32_t place = planes.count;
    if (place == kMaxFaces) {
      place = planes.plane[1].distance > planes.plane[2].distance ? 1U : 2U;
    }
    if (plane.distance < planes.plane[place].distance && !continues(planes, plane)) {
      planes.plane[place] = plane;
      planes.count += place == planes.count ? 1U : 0U;
      added |= 1U << place;
    }
  }
  return added;
}

void Neighbour::bring(const Pose& from, const Pose& to) {
  if (from == to) {
    return;
  }
  const Vec3 between = from.translation_m - to.translation_m;
  proxy = rotate_back(to.rotation, rotate(from.rotation, proxy) + between);
  found_at = rotate_back(to.rotation, rotate(from.rotation, found_at) + between);
  const std::uint32_t all = holding + ending;
  for (std::uint32_t i = 0; i < all; ++i) {  // bound: kMaxFaces
    const Vec3 normal = rotate(from.rotation, face[i].normal);
    face[i].normal = rotate_back(to.rotation, normal);
    face[i].offset_m += dot(normal, between);
  }
}

}  // namespace tactree::core
