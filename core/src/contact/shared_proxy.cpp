// The proxy that two bodies share: the faces that they exchange, and which of them leads.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "contact/face_fits.hpp"
#include "tactree/core/contact/neighbour.hpp"
#include "tactree/core/contact/proxy.hpp"

namespace tactree::core {
namespace {

// Faces closer to each other than this fraction of the support radius are flush; the faces of a
// crease are further apart.
constexpr float kFlush = kApart;

// After a yield by less than this fraction of the tolerance, a hundredth of the support radius, the
// own surface needs no other fit. Where the faces of two bodies meet, their fits differ by some
// nanometres in every tick. A proxy that settled each time would never go beyond its candidates.
constexpr float kSettled = 0.25F;

// The lead changes to the other body if the weight of its points is larger by this factor. The
// hysteresis prevents the lead from alternating.
constexpr float kMuchMore = 1.2F;

}  // namespace

[[gnu::noinline]] Neighbour Proxy::as_neighbour(const BlobView& view) const {
  Neighbour result = found_;
  result.leads = in_contact();
  result.proxy = position_;
  result.tolerance_m = kFlush * view.support_radius_m();
  result.holds = is_tracking() && planes_.count != 0U;
  if (inside_ || asks_) {
    result.holding = 0;
    result.ending = 0;
  }
  return result;
}

/// Begins a tick with this neighbour, or without one.
void Proxy::begin_beside(const Neighbour* neighbour) {
  neighbour_ = neighbour;
  must_hide_ = neighbour != nullptr;
  candidates_.show_all();
  if (in_contact() && (neighbour != nullptr || foreign_ != 0U)) {
    // at most: min(bodies, 2) / 2 * 2 per Scene::update
    meet(neighbour);
  }
}

/// Called before a fit, once a tick and after each gather. A proxy whose side is not known yet
/// needs all points: the nearest one determines the side. Points that the other body's faces hide
/// stay hidden until the proxy is so far from these faces that the points reappear at the boundary
/// of the support.
[[gnu::noinline]] void Proxy::hide_points(float radius) {
  if (neighbour_->holding != 0U && is_tracking() && !inside_ &&
      (neighbour_->holds || length_squared(neighbour_->found_at - position_) <= radius * radius)) {
    must_hide_ = false;
    // at most: min(bodies, 2) / 2 * min(fits, gathers + 2) per Scene::update
    candidates_.hide(*neighbour_, side_);
  }
}

/// Holds the proxy by the faces of a fit and, where this body leads, by those of the neighbour.
void Proxy::hold(const SurfaceFit& fit) {
  strength_ = fit.strength;
  planes_ = holding_planes(fit, side_);
  foreign_ = 0;
  found_.holding = 0;
  if (neighbour_ != nullptr) {
    // at most: min(bodies, 2) / 2 * fits per Scene::update
    hold_beside(fit);
  }
}

[[gnu::noinline]] void Proxy::add_foreign(ConstraintPlanes& planes) const {
  for (std::uint32_t i = 0; i < planes_.count && planes.count < kMaxFaces;
       ++i) {  // bound: kMaxFaces
    if ((foreign_ >> i & 1U) != 0U) {
      planes.plane[planes.count++] = planes_.plane[i];
    }
  }
}

[[gnu::noinline]] void Proxy::hold_beside(const SurfaceFit& fit) {
  const ConstraintPlanes faces = landing_planes(fit, side_);
  weight_ = fit.weight;
  found_.found_at = position_;
  found_.holding = 1U + fit.holding;
  found_.ending = fit.ending;
  for (std::uint32_t i = 0; i < faces.count; ++i) {  // bound: kMaxFaces
    const Plane& face = faces.plane[i];              // the ending faces are reversed
    const float sign = i < found_.holding ? 1.0F : -1.0F;
    found_.face[i] = {sign * face.normal, sign * (dot(face.normal, position_) - face.distance)};
  }
  if (in_contact()) {
    foreign_ = neighbour_->add_to(planes_, position_);
  }
}

/// Moves the proxy onto the plane of the main face.
void Proxy::move_to_first() {
  const Vec3 step = -planes_.plane[0].distance * planes_.plane[0].normal;
  position_ += step;
  planes_.step_by(step);
}

// The leading proxy came behind this surface. This proxy stays on the surface, and the leading one
// yields to it.
void Proxy::stop_at_surface() {
  move_to_first();
  blocked_ = true;
}

/// Holds the proxy by its own faces and those of the neighbour, if there is one.
[[gnu::noinline]] void Proxy::meet(const Neighbour* neighbour) {
  std::uint32_t own = 0;
  for (std::uint32_t i = 0; i < planes_.count; ++i) {  // bound: kMaxFaces
    if ((foreign_ >> i & 1U) == 0U) {
      planes_.plane[own++] = planes_.plane[i];
    }
  }
  for (std::uint32_t i = own; i < kMaxFaces; ++i) {  // bound: kMaxFaces
    planes_.plane[i] = Plane{};
  }
  planes_.count = own;
  foreign_ = neighbour != nullptr ? neighbour->add_to(planes_, position_) : 0U;
}

void Proxy::yield_to(const Neighbour& neighbour) {
  meet(&neighbour);
  if (foreign_ == 0U) {
    return;
  }
  const Vec3 step = shortest_move(planes_, true).step;
  if (step != Vec3{}) {
    position_ += step;
    planes_.step_by(step);
    const float enough = kSettled * neighbour.tolerance_m;
    unsettled_ = unsettled_ || length_squared(step) > enough * enough;
  }
}

void Proxy::aim(Vec3 probe) {
  if (planes_.count > 1U) {
    (void)move_of(probe);
  }
}

/// True if one of the neighbour's faces that hold the probe touches the proxy.
[[gnu::noinline]] bool Proxy::touches_neighbour() const {
  bool touches = false;
  for (std::uint32_t i = 0; i < planes_.count; ++i) {  // bound: kMaxFaces
    const bool holds = (active_ & foreign_ & 1U << i) != 0U;
    touches = touches || (holds && planes_.plane[i].distance <= neighbour_->tolerance_m);
  }
  return touches;
}

bool Proxy::belongs_to(const Proxy& follower, const Neighbour& neighbour, Vec3 probe) const {
  if (!neighbour.holds || follower.is_waiting() || !(follower.strength_ > 0.0F)) {
    return false;
  }
  const NeighbourFace& face = neighbour.face[0];
  const float near = neighbour.tolerance_m / kFlush;
  const bool is_there = length_squared(neighbour.proxy - position_) <= near * near;
  const bool touches = absolute(face.height_of(position_)) <= neighbour.tolerance_m;
  if (!is_there || !touches || !(face.height_of(probe) < 0.0F)) {
    return false;
  }
  const bool is_same = dot(face.normal, planes_.plane[0].normal) > kCreaseCosine;
  return gives_way_ || (is_same && follower.weight_ > kMuchMore * weight_);
}

void Proxy::take_over(const Neighbour& neighbour, Proxy& from) {
  state_ = from.state_;
  strength_ = from.strength_;
  stride_ = 1.0F;
  unsettled_ = true;
  has_next_ = false;
  planes_.step_by(neighbour.proxy - position_);
  position_ = neighbour.proxy;
  foreign_ = neighbour.add_to(planes_, position_);
  from.state_ = State::kTracking;  // keeps its faces
  from.unsettled_ = false;
  from.has_next_ = false;
}

// Decomposes the force along the normals of the planes that hold the probe, and returns the part
// along those of the neighbour.
[[gnu::noinline]] Vec3 Proxy::share_of_neighbour(Vec3 force) const {
  const std::uint32_t foreign = active_ & foreign_;
  if (planes_.count <= 1U || foreign == 0U) {
    return {};
  }
  if (foreign == active_) {
    return force;
  }
  Vec3 normal[2 * kMaxFaces - 1];
  std::uint32_t count = 0;
  std::uint32_t foreign_of = 0;                        // bit i: normal i
  for (std::uint32_t i = 0; i < planes_.count; ++i) {  // bound: kMaxFaces
    if ((active_ >> i & 1U) != 0U) {
      foreign_of |= (foreign >> i & 1U) << count;
      normal[count++] = planes_.plane[i].normal;
    }
  }
  if (count == 2U) {
    normal[2] = cross(normal[0], normal[1]);
  }
  normal[3] = normal[0];
  normal[4] = normal[1];
  Vec3 share{};
  for (std::uint32_t i = 0; i < count; ++i) {  // bound: kMaxFaces
    const Vec3 across = cross(normal[i + 1U], normal[i + 2U]);
    const float determinant = dot(normal[i], across);
    const float along = dot(force, across);
    if ((foreign_of >> i & 1U) != 0U && absolute(determinant) > kNoCommonPoint &&
        along * determinant > 0.0F) {
      share += (along / determinant) * normal[i];
    }
  }
  return share;
}

}  // namespace tactree::core
