// The states and transitions of the proxy; the budget of a tick.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/proxy.hpp"

namespace tactree::core {
namespace {

// Steps per tick. Each takes a gather, or uses the candidates of the last one.
constexpr std::uint32_t kSteps = 4;

// Slip ends below this share of the dynamic cone, not at its boundary: a slow probe whose encoder
// counts nothing in a tick has not stopped, and would alternate between stick and slip.
constexpr float kStickShare = 0.9F;

// Largest change of the strength per support radius of travel. It damps the flicker where points
// are so sparse that a single one makes a boundary.
constexpr float kStrengthPerRadius = 4.0F;

// A first support whose facing share is lower is a stray normal, not the other side.
constexpr float kContradicted = 0.2F;

// Within this share of the support radius of the surface one Newton step leaves an error below
// 1e-4 of the radius, whatever the curvature. Longer steps around a bend take a second one.
constexpr float kOneStepIsEnough = 0.01F;

float clamp(float value, float low, float high) {
  return value < low ? low : (value > high ? high : value);
}

float step_length(const BlobView& view) { return 0.5F * view.support_radius_m(); }

}  // namespace

void Proxy::reset(Vec3 probe) {
  candidates_.clear();
  position_ = probe;
  lost_contact_ = false;
  lose_support();
}

void Proxy::update(const BlobView& view, Vec3 probe, const Friction& friction,
                   const SurfaceWork& work) {
  if (surface_support(view) != SurfaceSupport::kOk) {
    reset(probe);
    return;
  }
  budget_.begin(work);
  lost_contact_ = false;
  if (in_contact()) {
    slide(view, probe, friction);
  }
  if (!in_contact()) {
    sweep(view, probe);
  }
}

bool Proxy::may_fit() const {
  return budget_.allows_fit() && (is_tracking() || budget_.allows_search());
}

bool Proxy::gather(const BlobView& view, Vec3 x) {
  GatherSlice& slice = budget_.spend_gather();
  if (!candidates_.is_gathering()) {
    candidates_.begin_for(view, x);
  }
  // at most: gathers per Scene::update
  return candidates_.gather(view, slice);
}

// Provides candidates for a fit at x. False: the budget ends here; has_next_ is true if a gather
// for x has been begun.
bool Proxy::prepare_fit(const BlobView& view, Vec3 x) {
  if (!may_fit()) {
    return false;
  }
  if (candidates_.covers(x)) {
    return true;
  }
  if (!budget_.allows_gather()) {
    return false;
  }
  has_next_ = !gather(view, x) || !may_fit();
  next_ = x;
  return !has_next_ && candidates_.covers(x);
}

SurfaceFit Proxy::evaluate(const BlobView& view, Vec3 x, Vec3 reference) {
  const SurfaceFit fit = fit_surface(candidates_, x, view.support_radius_m(), reference);
  budget_.spend_passes(fit.passes);
  return fit;
}

void Proxy::sweep(const BlobView& view, Vec3 probe) {
  const float step = step_length(view);
  for (std::uint32_t i = 0; i < kSteps; ++i) {  // bound: kSteps
    const Vec3 path = probe - position_;
    const float distance = length(path);
    const bool last = !has_next_ && !(distance > step);
    Vec3 x = last ? probe : position_ + (step / distance) * path;
    if (has_next_) {
      x = next_;
      has_next_ = false;
    }
    // at most: fits + 1 per Proxy::sweep
    if (!prepare_fit(view, x)) {
      return;
    }
    visit(view, x);  // at most: fits per Scene::update together fits
    if (in_contact() || last) {
      return;
    }
  }
}

void Proxy::visit(const BlobView& view, Vec3 x) {
  position_ = x;
  if (candidates_.count() == 0U) {
    budget_.spend_passes(1U);
    lose_support();
    return;
  }
  Vec3 reference = reference_;
  if (state_ == State::kUntracked) {
    budget_.spend_search();
    const float radius = view.support_radius_m();
    // at most: searches per Scene::update
    const Candidate* const nearest = nearest_candidate(candidates_, x, radius);
    if (nearest == nullptr) {
      budget_.spend_passes(1U);
      return;
    }
    reference = nearest->normal;
  }
  SurfaceFit fit = evaluate(view, x, reference);
  if (is_contradicted(fit)) {
    if (!budget_.allows_fit()) {
      reference_ = -reference;
      state_ = State::kReversed;
      return;
    }
    state_ = State::kUntracked;
    fit = evaluate(view, x, -reference);
  }
  if (!fit.firm()) {
    lose_support();
    return;
  }
  if (!is_tracking()) {
    side_ = fit.distance < 0.0F ? -1.0F : 1.0F;
    state_ = State::kTracking;
  }
  reference_ = fit.normal;
  if (side_ * fit.distance < 0.0F) {
    begin_contact(view, fit);
  }
}

// A tracked surface that was crossed begins a contact, whichever side its other points face.
bool Proxy::is_contradicted(const SurfaceFit& fit) const {
  const bool crossed = is_tracking() && fit.firm() && side_ * fit.distance < 0.0F;
  return !crossed && state_ != State::kReversed && fit.facing < kContradicted;
}

void Proxy::begin_contact(const BlobView& view, const SurfaceFit& fit) {
  position_ -= fit.distance * fit.normal;
  strength_ = fit.strength;
  state_ = State::kSticking;
  unsettled_ = true;
  if (prepare_fit(view, position_) && !settle(view).supported) {
    lose_support();  // the step ended beyond the boundary
  }
}

// Moves the proxy onto the surface by one Newton step, if it is supported.
SurfaceFit Proxy::settle(const BlobView& view) {
  const SurfaceFit fit = evaluate(view, position_, reference_);
  if (fit.supported) {
    position_ -= fit.distance * fit.normal;
    reference_ = fit.normal;
    strength_ = fit.strength;
    unsettled_ = false;
  }
  return fit;
}

void Proxy::slide(const BlobView& view, Vec3 probe, const Friction& friction) {
  const float step = step_length(view);
  for (std::uint32_t i = 0; i < kSteps; ++i) {  // bound: kSteps
    const Vec3 displacement = probe - position_;
    const float height = dot(displacement, normal());
    if (height > 0.0F) {
      release();
      return;
    }
    const Vec3 along = displacement - height * normal();
    const float distance = length(along);
    const float cone = friction.dynamic_coefficient * -height;
    const bool slips = distance > (slipping() ? cone : friction.static_coefficient * -height);
    if (!slips && !unsettled_) {
      end_slip(distance, cone);
      return;
    }
    const float excess = distance - cone;
    bool last = !(excess > step);
    Vec3 slip = slips ? ((last ? excess : step) / distance) * along : Vec3{};
    if (unsettled_ && !candidates_.will_cover(position_ + slip)) {
      slip = {};  // settle within the present candidates first, or the proxy would never settle
      last = false;
    }
    if (slips) {
      state_ = State::kSlipping;
    }
    // at most: fits + 1 per Proxy::slide
    if (!prepare_fit(view, position_ + slip)) {
      glide_by(slip);
      return;
    }
    // at most: fits per Scene::update together fits
    if (!slip_by(view, slip)) {
      lost_contact_ = true;
      lose_support();
      return;
    }
    if (last) {
      return;
    }
  }
}

void Proxy::end_slip(float distance, float cone) {
  if (!(distance > kStickShare * cone)) {
    state_ = State::kSticking;
  }
}

// Moves along the tangent plane while the candidates wait for the next tick.
void Proxy::glide_by(Vec3 step) {
  if (has_next_ && candidates_.will_cover(position_ + step)) {
    position_ += step;
    unsettled_ = true;
  }
  has_next_ = false;
}

bool Proxy::slip_by(const BlobView& view, Vec3 step) {
  const Vec3 position_before = position_;
  const float strength_before = strength_;
  position_ += step;
  const float radius = view.support_radius_m();
  const SurfaceFit fit = settle(view);
  if (!fit.supported) {
    return false;
  }
  unsettled_ = absolute(fit.distance) > kOneStepIsEnough * radius;
  if (unsettled_ && prepare_fit(view, position_) && !settle(view).supported) {
    return false;
  }
  const float change = kStrengthPerRadius * length(position_ - position_before) / radius;
  strength_ = clamp(strength_, strength_before - change, strength_before + change);
  return true;
}

// Ends the contact. Side and reference stay valid for the sweep that follows.
void Proxy::release() {
  state_ = State::kTracking;
  unsettled_ = false;
  strength_ = 0.0F;
}

void Proxy::lose_support() {
  release();
  state_ = State::kUntracked;
  has_next_ = false;
  reference_ = {};
  side_ = 1.0F;
}

}  // namespace tactree::core
