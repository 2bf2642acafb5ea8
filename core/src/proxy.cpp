// memory: RAM

#include "tactree/core/proxy.hpp"

namespace tactree::core {
namespace {

// Steps of one tick: each takes a gather, or goes on where the last one was good for.
constexpr std::uint32_t kSteps = 4;
// A fit takes one pass, and one more at a crease: none begins without both.
constexpr std::uint32_t kPassesOfFit = 2;

// Slip ends below this share of the dynamic cone, not at its rim: a slow probe whose encoder did
// not count in this tick has not stopped, and would stick and slip in turn.
constexpr float kStickShare = 0.9F;

// Change of the strength over a way of one support radius. A rim takes most of it; where points are
// so sparse that one more or less makes a rim, it keeps the force from flickering.
constexpr float kStrengthPerRadius = 4.0F;

// First support on a point that nearly all others contradict: a stray normal, not the other side.
constexpr float kContradicted = 0.2F;

// Within this share of the support radius of the surface one Newton step leaves an error below
// 1e-4 of the radius, whatever the curvature: a second is for longer ways around a bend.
constexpr float kOneStepIsEnough = 0.01F;

float clamp(float value, float low, float high) {
  return value < low ? low : (value > high ? high : value);
}

float step_length(const BlobView& view) { return 0.5F * view.support_radius_m(); }

}  // namespace

void Proxy::reset(Vec3 probe) {
  candidates_.clear();
  position_ = probe;
  complete_ = true;
  lost_contact_ = false;
  lose_support();
}

void Proxy::update(const BlobView& view, Vec3 probe, const Friction& friction,
                   const SurfaceWork& work) {
  if (surface_support(view) != SurfaceSupport::kOk) {
    reset(probe);
    return;
  }
  left_ = work;                   // memory: flash
  searches_left_ = work.gathers;  // memory: flash
  lost_contact_ = false;
  if (in_contact_) {
    slide(view, probe, friction);
  }
  if (!in_contact_) {
    sweep(view, probe);
  }
}

bool Proxy::may_fit() const {
  return left_.passes >= kPassesOfFit && left_.all >= kPassesOfFit &&
         (tracked_ || searches_left_ != 0U);
}

bool Proxy::may_gather() const {
  const GatherSlice& slice = left_.slice;
  return left_.gathers != 0U && left_.all >= kGatherWork && slice.corners != 0U &&
         slice.points != 0U && slice.candidates != 0U;
}

bool Proxy::gather(const BlobView& view, Vec3 x) {
  --left_.gathers;
  left_.all -= kGatherWork;
  if (!candidates_.is_begun()) {
    candidates_.begin_for(view, x);
  }
  // at most: gathers per Scene::update
  const bool done = candidates_.gather(view, left_.slice);
  complete_ = complete_ && candidates_.complete();
  return done;
}

// Makes the candidates good for a fit at x; false: not in this tick, or that is all there is time
// for in it, and has_next_ says so.
bool Proxy::go_on(const BlobView& view, Vec3 x) {
  if (!may_fit()) {
    return false;
  }
  if (candidates_.covers(x)) {
    return true;
  }
  if (!may_gather()) {
    return false;
  }
  has_next_ = !gather(view, x) || !may_fit();
  next_ = x;
  return !has_next_ && candidates_.covers(x);
}

void Proxy::spend(std::uint32_t passes) {
  left_.passes -= passes;
  left_.all -= passes;
}

SurfaceFit Proxy::evaluate(const BlobView& view, Vec3 x, Vec3 reference) {
  const SurfaceFit fit = fit_surface(candidates_, x, view.support_radius_m(), reference);
  spend(fit.passes);
  return fit;
}

void Proxy::sweep(const BlobView& view, Vec3 probe) {
  const float step = step_length(view);
  for (std::uint32_t i = 0; i < kSteps; ++i) {  // bound: kSteps
    const Vec3 way = probe - position_;
    const float distance = length(way);
    const bool last = !has_next_ && !(distance > step);
    Vec3 x = last ? probe : position_ + (step / distance) * way;
    if (has_next_) {
      x = next_;
      has_next_ = false;
    }
    // at most: fits + 1 per Proxy::sweep
    if (!go_on(view, x)) {
      return;
    }
    visit(view, x);  // at most: fits per Scene::update together fits
    if (in_contact_ || last) {
      return;
    }
  }
}

void Proxy::visit(const BlobView& view, Vec3 x) {
  position_ = x;
  if (candidates_.count() == 0U) {
    spend(1U);
    lose_support();
    return;
  }
  Vec3 reference = reference_;
  if (!tracked_ && !turned_) {
    --searches_left_;
    const float radius = view.support_radius_m();
    // at most: searches per Scene::update
    const Candidate* const nearest = nearest_candidate(candidates_, x, radius);
    if (nearest == nullptr) {
      spend(1U);
      return;
    }
    reference = nearest->normal;
  }
  SurfaceFit fit = evaluate(view, x, reference);
  const bool crossed = tracked_ && fit.firm() && side_ * fit.distance < 0.0F;
  if (!crossed && !turned_ && fit.facing < kContradicted) {
    tracked_ = false;
    if (left_.passes < kPassesOfFit || left_.all < kPassesOfFit) {
      reference_ = -reference;
      turned_ = true;
      return;  // the next tick looks again
    }
    fit = evaluate(view, x, -reference);
  }
  turned_ = false;
  if (!fit.firm()) {
    lose_support();
    return;
  }
  if (!tracked_) {
    side_ = fit.distance < 0.0F ? -1.0F : 1.0F;
    tracked_ = true;
  }
  reference_ = fit.normal;
  if (side_ * fit.distance < 0.0F) {
    begin_contact(view, fit);
  }
}

void Proxy::begin_contact(const BlobView& view, const SurfaceFit& fit) {
  position_ -= fit.distance * fit.normal;
  strength_ = fit.strength;
  slipping_ = false;
  in_contact_ = true;
  unsettled_ = true;
  if (go_on(view, position_) && !settle(view).supported) {
    lose_support();  // the way led past the rim
  }
}

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
    const Vec3 way = probe - position_;
    const float height = dot(way, normal());
    if (height > 0.0F) {
      release();
      return;
    }
    const Vec3 along = way - height * normal();
    const float distance = length(along);
    const float cone = friction.dynamic_coefficient * -height;
    const bool slips = distance > (slipping_ ? cone : friction.static_coefficient * -height);
    if (!slips && !unsettled_) {
      slipping_ = slipping_ && distance > kStickShare * cone;
      return;
    }
    const float excess = distance - cone;
    bool last = !(excess > step);
    Vec3 slip = slips ? ((last ? excess : step) / distance) * along : Vec3{};
    if (unsettled_ && !candidates_.will_cover(position_ + slip)) {
      slip = {};  // first where it is being gathered, else the proxy would glide for ever
      last = false;
    }
    slipping_ = slipping_ || slips;
    // at most: fits + 1 per Proxy::slide
    if (!go_on(view, position_ + slip)) {
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

// While the candidates wait for the next tick.
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
  if (unsettled_ && go_on(view, position_) && !settle(view).supported) {
    return false;
  }
  const float change = kStrengthPerRadius * length(position_ - position_before) / radius;
  strength_ = clamp(strength_, strength_before - change, strength_before + change);
  return true;
}

// The probe is on the outer side again: what was tracked stays, so that the sweep which follows
// knows on which side it starts.
void Proxy::release() {
  in_contact_ = false;
  slipping_ = false;
  unsettled_ = false;
  strength_ = 0.0F;
}

void Proxy::lose_support() {
  release();
  tracked_ = false;
  turned_ = false;
  has_next_ = false;
  reference_ = {};
  side_ = 1.0F;
}

}  // namespace tactree::core
