// The states and transitions of the proxy; the budget of a tick.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/proxy.hpp"

#include "tactree/core/model/interior.hpp"

namespace tactree::core {
namespace {

// Steps per tick, of half a support radius each, so that none passes through a thin plate: 5 m/s at
// 1 kHz with a radius of 2.5 mm. The proxy follows a faster probe in the next ticks. Each step
// takes a gather, or uses the candidates of the last one.
constexpr std::uint32_t kSteps = 4;

// Slip ends below this fraction of the dynamic cone, not at its boundary. A slow probe whose
// encoders report no count in a tick has not stopped, and would otherwise alternate between stick
// and slip. 1 mm deep with a coefficient of 0.3, the cone is 0.3 mm and a tenth of it is 1.5 counts
// of 20 um. The smaller the fraction, the later a hand that reverses sticks again.
constexpr float kStickShare = 0.9F;

// Maximum change of the strength per support radius of travel. It damps the flicker where points
// are so sparse that a single one makes a boundary. At the boundary of an even sheet the strength
// falls by at most 3.5 per radius, and is not delayed.
constexpr float kStrengthPerRadius = 4.0F;

// If less than this fraction of the weight faces a new reference, the reference is a stray normal
// and is reversed; the probe is not on the other side of a sheet. On a plate thinner than the
// support it is about 0.5, which must not reverse the reference.
constexpr float kContradicted = 0.2F;

// A Newton step shorter than this fraction of the support radius leaves an error below 1e-4 of the
// radius at any curvature. After a longer one, around a bend, a second step follows.
constexpr float kOneStepIsEnough = 0.01F;

// A step that leads away from the probe is taken back, and the next ones are shorter: the probe is
// deeper than the radius of the bend ahead, and the force would alternate every tick (by 0.6 N at a
// tight bend). Factor of the step length after such a step, after any other step, and minimum of
// the length; six other steps then restore the full length. A step of the minimum length is not
// taken back: where even that one leads away, as where two sheets meet, the proxy would never
// leave.
constexpr float kShorter = 0.4F;
constexpr float kLonger = 1.5F;
constexpr float kShortest = 0.1F;

// A face touches the proxy within this fraction of the support radius, ten times the error that a
// Newton step leaves. With the friction of faces that it does not touch, the proxy stuck 31 um
// above the bottom of a groove of 60 degrees.
constexpr float kTouching = 0.001F;

float clamp(float value, float low, float high) {
  return value < low ? low : (value > high ? high : value);
}

/// A step of length `step` in the direction of `way`; zero if `way` is zero.
Vec3 along(Vec3 way, float step) {
  const float all = length(way);
  return all > 0.0F ? (step / all) * way : Vec3{};
}

float smaller_of(float a, float b) { return a < b ? a : b; }

float step_length(const BlobView& view) { return 0.5F * view.support_radius_m(); }

}  // namespace

void Proxy::reset(Vec3 probe) {
  candidates_.clear();
  found_.holding = 0;
  position_ = probe;
  lost_contact_ = false;
  inside_ = false;
  lose_support();
}

void Proxy::update(const BlobView& view, Vec3 probe, const Friction& friction,
                   const SurfaceWork& work, const Neighbour* neighbour) {
  if (surface_support(view) != SurfaceSupport::kOk) {
    reset(probe);
    return;
  }
  budget_.begin(work);
  candidates_.use_both(work.gathers_ahead());  // memory: flash
  const Vec3 begin = position_;
  lost_contact_ = false;
  blocked_ = false;
  gives_way_ = false;
  begin_beside(neighbour);
  if (in_contact()) {
    slide(view, probe, friction);
  } else if (asks_) {
    look_behind(view);  // at most: passes per Scene::update together passes
  }
  if (!in_contact()) {
    sweep(view, is_led() ? neighbour->proxy : probe);
  }
  if (candidates_.uses_both()) {
    gather_ahead(view, begin);  // at most: ahead per Proxy::update
  }
  neighbour_ = nullptr;
}

// Called where no point is within reach. Charged as a pass, but costs less.
[[gnu::noinline]] void Proxy::look_around(const BlobView& view) {
  budget_.spend_passes(1U);
  inside_ = interior_at(view, position_).here;
}

// Looks up the leaf of a point, not the cell of the proxy: cells near the surface may extend to
// both sides of it.
[[gnu::noinline]] void Proxy::look_behind(const BlobView& view) {
  budget_.spend_passes(1U);
  inside_ = interior_at(view, candidates_.in_use()[0].position).behind;
  asks_ = false;
}

SurfaceFit Proxy::evaluate(const BlobView& view, Vec3 x) {
  // at most: fits per Scene::update together evaluations
  const SurfaceFit fit =
      fit_surface(candidates_.in_use(), x, view.support_radius_m(), reference_, side_, near_);
  budget_.spend_passes(fit.passes);
  if (!fit.complete) {
    candidates_.report_omission();
  }
  return fit;
}

void Proxy::sweep(const BlobView& view, Vec3 probe) {
  const float step = step_length(view);
  for (std::uint32_t i = 0; i < kSteps; ++i) {  // bound: kSteps
    if (!has_next_) {
      const Vec3 path = probe - position_;
      const float distance = length(path);
      next_ = distance > step ? position_ + (step / distance) * path : probe;
    }
    has_next_ = false;
    // at most: fits_of_one + 1 per Proxy::sweep
    if (!prepare_fit(view, next_)) {
      return;
    }
    visit(view);  // at most: fits per Scene::update together fits
    const bool arrived = next_ == probe && !has_next_;
    if (in_contact() || arrived || asks_ || blocked_) {
      return;
    }
  }
}

// Returns false if no point is within reach, or if there is no reference and all points in the
// support are hidden.
bool Proxy::has_reference(const BlobView& view) {
  const CandidateSet& points = candidates_.in_use();
  if (points.count() + points.hidden() == 0U) {
    lose_support();
    return false;
  }
  if (reference_ != Vec3{}) {
    return true;
  }
  budget_.spend_passes(1U);
  // at most: passes per Scene::update together passes
  const Candidate* const nearest = nearest_candidate(points, next_, view.support_radius_m());
  if (nearest == nullptr) {
    return false;
  }
  reference_ = nearest->normal;
  return true;
}

void Proxy::visit(const BlobView& view) {
  if (!has_reference(view)) {
    position_ = next_;
    was_free_ = false;
    if (!is_tracking()) {
      look_around(view);  // at most: passes per Scene::update together passes
    }
    return;
  }
  const bool was_smooth = near_.count == 0U;
  const SurfaceFit fit = evaluate(view, next_);
  if (rejects(fit, was_smooth)) {
    return;
  }
  const Vec3 step = next_ - position_;
  position_ = next_;
  if (passes_by(fit, step)) {
    reference_ = fit.back.normal;
    near_.count = 0;
    inside_ = inside_ && side_ < 0.0F;
    was_free_ = false;
    state_ = State::kTracking;
    return;
  }
  if (!is_tracking()) {
    // Behind a surface, look_behind() first determines in the next tick whether that is in the
    // material. Another body holds the leading proxy outside: up to the tolerance, a follower
    // behind the surface counts as in front of it.
    const float height = is_led() ? fit.distance + neighbour_->tolerance_m : fit.distance;
    const bool crosses = was_free_ && fit.distance - dot(fit.normal, step) > 0.0F;
    was_free_ = false;
    asks_ = height < 0.0F && !crosses;
    inside_ = inside_ && asks_;
    side_ = asks_ ? -1.0F : 1.0F;
    state_ = State::kTracking;
  }
  refer_to(fit, was_smooth);
  hold(fit);
  std::uint32_t lowest = 0;
  for (std::uint32_t i = 1; i < planes_.count; ++i) {  // bound: kMaxFaces
    lowest = planes_.plane[i].distance < planes_.plane[lowest].distance ? i : lowest;
  }
  make_main(lowest);
  if (!(planes_.plane[0].distance < 0.0F) || asks_) {
    return;
  }
  if (inside_) {  // it leaves the material
    inside_ = false;
    side_ = 1.0F;
    return;
  }
  if (is_led()) {
    stop_at_surface();
    return;
  }
  begin_contact(view);
}

// Returns true if a fit at next_ is not one of the surface that the proxy follows. It has then lost
// that surface, or it looks for another one: with further faces, with the opposite reference where
// most points face away, or with the nearest point where the tracked face is out of reach. From
// free space, the step is repeated then. A tracked surface that was crossed begins a contact,
// whichever side its other points face. Where points are hidden, those that face the reference may
// be among them.
bool Proxy::rejects(const SurfaceFit& fit, bool was_smooth) {
  const bool is_firm = fit.firm();
  const bool is_behind = side_ * fit.distance < 0.0F;
  const bool is_open = candidates_.in_use().hidden() == 0U;
  const bool is_stray = fit.facing < kContradicted && state_ != State::kReferenced && is_open &&
                        !(is_tracking() && is_firm && is_behind);
  if (is_firm && !is_stray) {
    // A crease that comes near: its faces are separated before a contact begins.
    has_next_ = was_smooth && near_.count != 0U && (!is_tracking() || is_behind);
    if (has_next_ && !is_tracking()) {
      state_ = State::kReferenced;
    }
    return has_next_;
  }
  const bool begins_free = is_tracking() ? !inside_ && is_open : was_free_;
  if (is_stray) {
    reference_ = -reference_;
    near_.count = 0;
    state_ = State::kReferenced;
  } else if (is_tracking() && begins_free) {
    lose_support();
  } else {
    position_ = next_;
    lose_face(fit);
    return true;
  }
  was_free_ = begins_free;
  has_next_ = begins_free;
  if (!begins_free) {
    position_ = next_;
  }
  return true;
}

// Returns true if the step went around the edge of a plate or over a ridge: when it fell behind the
// face, it was in front of the back, not between the two. If the side is not known yet, it is
// sufficient that the step ends in front of the back.
bool Proxy::passes_by(const SurfaceFit& fit, Vec3 step) const {
  const float height = side_ * fit.distance;
  const float back_height = side_ * fit.back.distance;
  if (fit.back.normal == Vec3{} || !(height < 0.0F && back_height > 0.0F)) {
    return false;
  }
  const float fall = -side_ * dot(fit.normal, step);
  const float behind = fall > -height ? -height / fall : 1.0F;  // fraction of the step
  return !is_tracking() || back_height > behind * side_ * dot(fit.back.normal, step);
}

void Proxy::begin_contact(const BlobView& view) {
  move_to_first();
  state_ = State::kSticking;
  unsettled_ = true;
  stride_ = 1.0F;
  float moved = 0.0F;
  // at most: fits per Scene::update together settles
  if (prepare_fit(view, position_) && !settle(view, moved)) {
    lose_support();  // the step ended beyond the boundary of the surface
  }
  common_normal_ = side_ * reference_;
}

// The first fit near a crease is smooth. Its normal lies between those of the faces and could not
// separate them; the reference is kept.
void Proxy::refer_to(const SurfaceFit& fit, bool was_smooth) {
  if (fit.next_reference != Vec3{}) {
    reference_ = fit.next_reference;
  } else if (!was_smooth || near_.count == 0U) {
    reference_ = fit.normal;
  }
}

/// Makes the face of this plane the main face, whose normal is reference_.
void Proxy::make_main(std::uint32_t plane) {
  if (plane == 0U) {
    return;
  }
  const Plane first = planes_.plane[0];
  planes_.plane[0] = planes_.plane[plane];
  planes_.plane[plane] = first;
  active_ = (active_ & ~(1U << plane)) | 1U;
  const Vec3 reference = side_ * planes_.plane[0].normal;
  for (std::uint32_t i = 0; i < near_.count; ++i) {  // bound: kMaxFaces
    if (near_.normal[i] == reference) {
      near_.normal[i] = reference_;
    }
  }
  reference_ = reference;
}

/// Returns the shortest move of the probe to the front of all faces, and updates active_ and
/// common_normal_.
PlaneMove Proxy::move_of(Vec3 probe) {
  ConstraintPlanes planes = planes_;
  planes.step_by(probe - position_);
  const PlaneMove move = shortest_move(planes, false);
  active_ = move.active;
  common_normal_ = normalized_or(move.step, side_ * reference_);
  return move;
}

// Moves the proxy onto the surface by one Newton step, of length `moved`. Returns false if the
// surface is not supported there.
bool Proxy::settle(const BlobView& view, float& moved) {
  const bool was_smooth = near_.count == 0U;
  const SurfaceFit fit = evaluate(view, position_);
  if (!fit.supported) {
    return false;
  }
  refer_to(fit, was_smooth);
  unsettled_ = false;
  hold(fit);
  if (fit.holding + fit.ending == 0U && foreign_ == 0U) {
    position_ -= fit.distance * fit.normal;
    planes_.plane[0].distance = 0.0F;
    moved = absolute(fit.distance);
  } else {
    ConstraintPlanes landing = landing_planes(fit, side_);
    if (foreign_ != 0U) {
      // at most: min(bodies, 2) / 2 * fits per Scene::update
      add_foreign(landing);
    }
    const Vec3 step = shortest_move(landing, true).step;
    position_ += step;
    planes_.step_by(step);
    moved = length(step);
  }
  return true;
}

// Faces ahead of the proxy stop it, but have no friction: while one is ahead, only the main face
// has friction.
Proxy::Pull Proxy::pull_of(const BlobView& view, Vec3 probe) {
  const Vec3 displacement = probe - position_;
  if (planes_.count <= 1U) {
    common_normal_ = normal();  // if further faces appear, until the next move_of()
    const float height = dot(displacement, common_normal_);
    const Vec3 along = displacement - height * common_normal_;
    return {height > 0.0F, along, -height, length(along)};
  }
  const PlaneMove all = move_of(probe);
  const std::uint32_t own = all.active & ~foreign_;
  if (own == 0U && foreign_ != 0U) {
    // at most: min(bodies, 2) / 2 * 2 per Scene::update
    gives_way_ = touches_neighbour();
  }
  if (own != 0U && (own & 1U) == 0U) {
    make_main((own & 2U) != 0U ? 1U : 2U);
  }
  const float reach = kTouching * view.support_radius_m();
  const Plane& main = planes_.plane[0];
  const bool is_ahead = planes_.plane[1].distance > reach ||
                        (planes_.count == kMaxFaces && planes_.plane[2].distance > reach);
  Vec3 step = all.step;
  if (main.distance <= reach && is_ahead) {
    step = -(main.distance + dot(main.normal, displacement)) * main.normal;
  }
  return {own == 0U && !gives_way_, displacement + all.step, length(step),
          length(displacement + step)};
}

Proxy::Footing Proxy::footing() const {
  return {position_, reference_, near_, planes_, foreign_, strength_};
}

void Proxy::restore(const Footing& footing) {
  position_ = footing.position;
  reference_ = footing.reference;
  near_ = footing.near;
  planes_ = footing.planes;
  foreign_ = footing.foreign;
  strength_ = footing.strength;
  unsettled_ = false;
  has_next_ = false;
}

/// The next step of a slip by `excess` (m), at most `step` (m) long. Sets `last` if it completes
/// the slip.
Vec3 Proxy::next_slip(const Pull& pull, float excess, float step, bool& last) const {
  const float length_left = smaller_of(excess, length(pull.along));
  last = !(length_left > step);
  const Vec3 slip = along(pull.along, stride_ * (last ? length_left : step));
  if (unsettled_ && !candidates_.will_cover(position_ + slip)) {
    last = false;
    return {};  // settle within the present candidates first, or the proxy would never settle
  }
  return slip;
}

void Proxy::slide(const BlobView& view, Vec3 probe, const Friction& friction) {
  const float step = step_length(view);
  for (std::uint32_t i = 0; i < kSteps; ++i) {  // bound: kSteps
    // at most: max(1, fits_of_one) per Proxy::slide
    const Pull pull = pull_of(view, probe);
    if (pull.released) {
      release();
      return;
    }
    if (gives_way_) {
      return;
    }
    const float cone = friction.dynamic_coefficient * pull.depth;
    const bool slips =
        pull.distance > (slipping() ? cone : friction.static_coefficient * pull.depth);
    if (!slips && !unsettled_) {
      end_slip(pull.distance, cone);
      return;
    }
    bool last = false;
    const Vec3 slip = next_slip(pull, slips ? pull.distance - cone : 0.0F, step, last);
    if (slips) {
      state_ = State::kSlipping;
    }
    // at most: fits_of_one + 1 per Proxy::slide
    if (!prepare_fit(view, position_ + slip)) {
      glide_by(slip);
      return;
    }
    const bool was_settled = !unsettled_;
    const Footing before = footing();
    // at most: fits per Scene::update together fits
    if (!slip_by(view, slip, probe)) {
      if (candidates_.in_use().hidden() != 0U) {  // the surface ends inside the neighbour
        restore(before);
        gives_way_ = true;
        return;
      }
      lost_contact_ = true;
      lose_support();
      return;
    }
    last = !takes_back(view, slip, probe, before, was_settled) && last;
    if (last || !budget_.allows_fit()) {
      return;
    }
  }
}

// Takes back a step that began at a settled position and led away from the probe. Short steps are
// exempt: they are within the errors of the fits.
bool Proxy::takes_back(const BlobView& view, Vec3 slip, Vec3 probe, const Footing& before,
                       bool was_settled) {
  const bool is_long = length(slip) > kOneStepIsEnough * view.support_radius_m();
  const bool leads_away =
      length_squared(probe - position_) > length_squared(probe - before.position);
  if (!was_settled || !is_long || !leads_away || !(stride_ > kShortest)) {
    stride_ = smaller_of(kLonger * stride_, 1.0F);
    return false;
  }
  restore(before);
  stride_ = clamp(kShorter * stride_, kShortest, 1.0F);
  return true;
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
    planes_.step_by(step);
    unsettled_ = true;
  }
  has_next_ = false;
}

/// True if one face holds the proxy, and the probe is in front of it.
bool Proxy::is_free(Vec3 probe) const {
  return planes_.count == 1U && dot(probe - position_, normal()) > 0.0F;
}

// A slip around an edge ends on the face of which the probe is in front. A second step would start
// at the edge itself, where either face may be the surface.
bool Proxy::slip_by(const BlobView& view, Vec3 step, Vec3 probe) {
  const Vec3 position_before = position_;
  const float strength_before = strength_;
  position_ += step;
  const float radius = view.support_radius_m();
  float moved = 0.0F;
  // at most: fits per Scene::update together settles
  if (!settle(view, moved)) {
    return false;
  }
  unsettled_ = moved > kOneStepIsEnough * radius;
  // at most: fits per Scene::update together settles
  if (unsettled_ && !is_free(probe) && prepare_fit(view, position_) && !settle(view, moved)) {
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
  planes_.count = 0;
  foreign_ = 0;
}

void Proxy::lose_support() {
  release();
  state_ = State::kUntracked;
  has_next_ = false;
  was_free_ = false;
  reference_ = {};
  near_.count = 0;
  side_ = 1.0F;
  asks_ = false;
}

// While the neighbour hides points, the side is kept: the points of the surface that appear next
// are seen from the same side.
void Proxy::lose_face(const SurfaceFit& fit) {
  if (!is_tracking() || candidates_.in_use().hidden() == 0U) {
    lose_support();
    return;
  }
  release();
  reference_ = fit.next_reference;
  near_.count = 0;
}

}  // namespace tactree::core
