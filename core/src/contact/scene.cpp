// Which bodies the probe reaches, the renderer of each, and the sum of their forces.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/scene.hpp"

namespace tactree::core {
namespace {

constexpr const char* kDescriptions[] = {
    "ok",
    "the controller is armed: stop first",
    "the controller is not configured",
    "there is no model",
    "the blob was built without the guarantees that surface mode needs",
    "a ball of the model may hold more points than the controller has room for",
    "a material is stiffer than device, hand and rate allow",
    "there is no room for another body",
    "no body has this number",
    "the pose is not finite, not a rotation, or beyond +-10 m",
    "the motion is not finite, or beyond 10 m/s or 100 rad/s",
    "a tick with this model may take longer than the rate allows",
};
constexpr std::uint32_t kDescriptionCount = sizeof(kDescriptions) / sizeof(kDescriptions[0]);

// Cosine of the largest angle between the forces of two ticks while the proxy falls.
constexpr float kFallDirection = 0.5F;

/// True if the path from `a` to `b` comes within `margin` of the interval.
bool touches(float a, float b, float low, float high, float margin) {
  return (a < b ? a : b) <= high + margin && (a < b ? b : a) >= low - margin;
}

/// True if the path comes near the model. The whole box of the path is compared, not only its end:
/// a fast probe could cross a thin model between two ticks.
bool comes_near(const BlobView& view, Vec3 from, Vec3 to) {
  const BlobHeader& h = view.header();
  const float margin = h.reach_m + h.aabb_edge_m;  // memory: flash
  // memory: flash
  return touches(from.x, to.x, h.bounds_min_m[0], h.bounds_max_m[0], margin) &&
         touches(from.y, to.y, h.bounds_min_m[1], h.bounds_max_m[1], margin) &&
         touches(from.z, to.z, h.bounds_min_m[2], h.bounds_max_m[2], margin);
}

void bring_to_scene(const Pose& pose, Rendering& r) {
  r.proxy = rotate(pose.rotation, r.proxy) + pose.translation_m;
  r.normal = rotate(pose.rotation, r.normal);
  r.force = rotate(pose.rotation, r.force);
}

}  // namespace

const char* describe(ModelStatus status) {
  const auto index = static_cast<std::uint32_t>(status);
  return index < kDescriptionCount ? kDescriptions[index] : "unknown status";
}

void Scene::clear() {
  for (Body& body : bodies_) {  // bound: kMaxBodies
    body = {};
  }
  list_bodies();
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    slot.body = kNoBody;
  }
  reset({});
}

ModelStatus Scene::add(const BlobView& view, const Pose& pose, std::uint32_t& number) {
  if (view.empty()) {
    return ModelStatus::kEmpty;
  }
  if (!is_valid(pose)) {
    return ModelStatus::kBadPose;
  }
  std::uint32_t free = 0;
  while (free < kMaxBodies && exists(free)) {  // bound: kMaxBodies
    ++free;
  }
  if (free == kMaxBodies) {
    return ModelStatus::kTooManyBodies;
  }
  Body& body = bodies_[free];
  body.view = view;
  body.pose = normalized(pose);
  body.moved = !is_origin(body.pose);
  number = free;
  list_bodies();
  return ModelStatus::kOk;
}

ModelStatus Scene::remove(std::uint32_t number) {
  if (!exists(number)) {
    return ModelStatus::kNoSuchBody;
  }
  release(number);
  bodies_[number] = {};
  list_bodies();
  return ModelStatus::kOk;
}

ModelStatus Scene::enable(std::uint32_t number, bool enabled) {
  if (!exists(number)) {
    return ModelStatus::kNoSuchBody;
  }
  if (!enabled) {
    release(number);
    bodies_[number].seen = false;
  }
  bodies_[number].enabled = enabled;
  return ModelStatus::kOk;
}

ModelStatus Scene::move(std::uint32_t number, const Pose& pose, const Motion& motion) {
  if (!exists(number)) {
    return ModelStatus::kNoSuchBody;
  }
  if (!is_valid(pose)) {
    return ModelStatus::kBadPose;
  }
  if (!is_valid(motion)) {
    return ModelStatus::kBadMotion;
  }
  Body& body = bodies_[number];
  body.pose = normalized(pose);
  body.motion = motion;
  body.moved = !(is_origin(body.pose) && is_rest(motion));
  return ModelStatus::kOk;
}

bool Scene::exists(std::uint32_t number) const {
  return number < kMaxBodies && !bodies_[number].view.empty();
}

void Scene::list_bodies() {
  count_ = 0;
  for (std::uint32_t number = 0; number < kMaxBodies; ++number) {  // bound: kMaxBodies
    if (exists(number)) {
      listed_[count_++] = static_cast<std::uint8_t>(number);
    }
  }
}

BlobView Scene::view(std::uint32_t number) const {
  return number < kMaxBodies ? bodies_[number].view : BlobView{};
}

Pose Scene::pose(std::uint32_t number) const {
  return exists(number) ? bodies_[number].pose : Pose{};
}

void Scene::reset(Vec3 probe) {
  for (Body& body : bodies_) {  // bound: kMaxBodies
    body.seen = false;
  }
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    const bool assigned = slot.body != kNoBody;
    assign_slot(slot, slot.body, assigned ? position_to_body(pose_of(slot), probe) : probe);
  }
  fade_.stop();
  force_ = {};
  led_ = kMaxReachableBodies;
  ended_ = false;
  rendering_ = SceneRendering{};
}

void Scene::assign_slot(Slot& slot, std::uint32_t number, Vec3 probe) {
  const bool led = number_of(slot) == led_;
  ended_ = ended_ || slot.in_contact || led;
  led_ = led ? kMaxReachableBodies : led_;
  slot.body = number;
  slot.renderer.reset(probe);
  slot.in_contact = false;
}

Scene::Slot* Scene::slot_of(std::uint32_t number) {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body == number) {
      return &slot;
    }
  }
  return nullptr;
}

/// An unassigned slot, or the slot of a body that is out of reach and not in contact, or null.
Scene::Slot* Scene::free_slot(const bool (&within_reach)[kMaxBodies]) {
  if (Slot* const unused = slot_of(kNoBody)) {
    return unused;
  }
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (!within_reach[slot.body] && !slot.in_contact) {
      return &slot;
    }
  }
  return nullptr;
}

void Scene::release(std::uint32_t number) {
  Slot* const slot = slot_of(number);
  if (slot != nullptr) {
    assign_slot(*slot, kNoBody, {});
  }
}

void Scene::locate_probe(Vec3 probe) {
  for (std::uint32_t i = 0; i < count_; ++i) {  // bound: listed
    Body& body = bodies_[listed_[i]];
    if (body.enabled) {
      body.probe =
          body.moved ? rotate_back(body.pose.rotation, probe - body.pose.translation_m) : probe;
      body.last_probe = body.seen ? body.last_probe : body.probe;
    }
  }
}

/// Assigns slots to the bodies within reach, and unused slots to the others. Returns true if a body
/// within reach got none. A proxy starts at the probe's last position, which was still out of
/// reach.
bool Scene::assign_slots() {
  bool within_reach[kMaxBodies] = {};
  for (std::uint32_t i = 0; i < count_; ++i) {  // bound: listed
    const std::uint32_t number = listed_[i];
    const Body& body = bodies_[number];
    within_reach[number] = body.enabled && comes_near(body.view, body.last_probe, body.probe);
  }
  bool crowded = false;
  for (std::uint32_t i = 0; i < count_; ++i) {  // bound: listed
    const std::uint32_t number = listed_[i];
    const Body& body = bodies_[number];
    if (!body.enabled || slot_of(number) != nullptr) {
      continue;
    }
    Slot* const slot = within_reach[number] ? free_slot(within_reach) : slot_of(kNoBody);
    if (slot != nullptr) {
      assign_slot(*slot, number, body.last_probe);
    }
    crowded = crowded || (within_reach[number] && slot == nullptr);
  }
  return crowded;
}

void Scene::release_backs() {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body != kNoBody) {
      slot.renderer.release_back(bodies_[slot.body].probe);
    }
  }
}

const SceneRendering& Scene::update(const Configuration& configuration, Vec3 probe, Vec3 velocity) {
  SceneRendering& all = rendering_;
  all.wall_velocity = {};
  all.fading = false;
  all.inside = false;
  for (Reaction& reaction : all.reactions) {  // bound: kMaxReachableBodies
    reaction.body = kNoBody;
  }
  locate_probe(probe);
  all.crowded = assign_slots();
  Slot* leader = nullptr;
  if (configuration.mode != RenderMode::kPaper) {
    leader = track_all(configuration);  // at most: 1 - paper per Scene::update
  }
  if (leader != nullptr) {
    render(*leader, configuration, probe, velocity);  // at most: 1 - paper per Scene::update
    led_ = number_of(*leader);
  } else {
    all.contact = Rendering{};
    all.contact.proxy = probe;
    if (led_ != kMaxReachableBodies) {
      fall(slots_[led_], probe);
    }
  }
  all.contact.complete = observe();
  if (configuration.mode == RenderMode::kPaper) {
    render_paper(configuration, probe);  // at most: paper per Scene::update
  }
  if (ended_) {
    const auto ticks = static_cast<std::uint32_t>(kFadeSeconds * configuration.rate_hz);
    fade_.begin(force_ - all.contact.force, ticks > 0U ? ticks : 1U);
    ended_ = false;
  }
  force_ = all.contact.force;
  if (fade_.active()) {
    all.contact.force += fade_.next();
    all.fading = true;
  }
  move_on(1.0F / configuration.rate_hz);
  return all;
}

/// The slot whose proxy is in contact, or null.
Scene::Slot* Scene::leading() {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.in_contact) {
      return &slot;
    }
  }
  return nullptr;
}

/// The body of `other` as a neighbour, in the frame of the body of `slot`.
[[gnu::noinline]] Neighbour Scene::neighbour_of(const Slot& slot, const Slot& other) const {
  Neighbour neighbour = other.renderer.proxy().as_neighbour(bodies_[other.body].view);
  neighbour.bring(pose_of(other), pose_of(slot));
  return neighbour;
}

/// Updates all proxies and returns the slot of the leading one, or null. The leading proxy is
/// updated first, because the other one follows it.
[[gnu::noinline]] Scene::Slot* Scene::track_all(const Configuration& configuration) {
  Slot* const led = leading();
  Slot* slot = led != nullptr ? led : slots_;
  for (std::uint32_t i = 0; i < kMaxReachableBodies; ++i) {  // bound: kMaxReachableBodies
    if (slot->body != kNoBody) {
      // at most: min(bodies, kMaxReachableBodies) per Scene::track_all
      track(*slot, configuration);
    }
    slot = &beside(*slot);
  }
  Slot* leader = led != nullptr && led->in_contact ? led : leading();
  if (leader != nullptr && beside(*leader).body != kNoBody) {
    // at most: min(bodies, 2) / 2 per Scene::track_all
    leader = share(*leader);
  }
  return leader;
}

/// Reports whether the probe is in the material of a body. Returns false if a model holds more
/// points than it declares.
bool Scene::observe() {
  bool complete = true;
  for (const Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body != kNoBody) {
      rendering_.inside = rendering_.inside || slot.renderer.proxy().inside();
      complete = complete && slot.renderer.proxy().complete();
    }
  }
  return complete;
}

// Ends the contact if the body or the probe jumps.
void Scene::end_contact_of_a_jump(Slot& slot, const Configuration& configuration) {
  const Body& body = bodies_[slot.body];
  const float furthest = 2.0F * configuration.supervision.speed_max_m_s / configuration.rate_hz;
  if (!(length_squared(body.probe - body.last_probe) <= furthest * furthest)) {
    assign_slot(slot, slot.body, body.probe);
  }
}

[[gnu::noinline]] void Scene::track(Slot& slot, const Configuration& configuration) {
  end_contact_of_a_jump(slot, configuration);
  const Body& body = bodies_[slot.body];
  const Slot& other = beside(slot);
  if (other.body != kNoBody) {
    // at most: min(bodies, 2) / 2 * 2 per Scene::track_all
    neighbour_ = neighbour_of(slot, other);
  }
  slot.renderer.track(body.view, configuration, body.probe, work_tier_,
                      other.body != kNoBody ? &neighbour_ : nullptr);
  slot.in_contact = slot.renderer.proxy().in_contact();
  ended_ = ended_ || slot.renderer.proxy().lost_contact();
}

/// Holds the leading proxy also by the faces that the following one has found. The follower takes
/// the lead where the surface is that of its body.
[[gnu::noinline]] Scene::Slot* Scene::share(Slot& leader) {
  Slot& follower = beside(leader);
  const Vec3 probe = bodies_[leader.body].probe;
  const Neighbour its = neighbour_of(leader, follower);
  Proxy& leads = leader.renderer.proxy();
  Proxy& follows = follower.renderer.proxy();
  leads.yield_to(its);
  const bool changes = leads.belongs_to(follows, its, probe);
  if (changes) {
    follows.take_over(neighbour_of(follower, leader), leads);
    leader.in_contact = false;
    follower.in_contact = true;
  }
  Slot& now = changes ? follower : leader;
  now.renderer.proxy().aim(bodies_[now.body].probe);
  return &now;
}

[[gnu::noinline]] void Scene::render(Slot& slot, const Configuration& configuration, Vec3 probe,
                                     Vec3 velocity) {
  SceneRendering& all = rendering_;
  const Body& body = bodies_[slot.body];
  Vec3 relative = velocity;
  Vec3 seen_velocity = velocity;
  if (body.moved) {
    relative = relative_velocity(body.pose, body.motion, probe, velocity);
    seen_velocity = direction_to_body(body.pose, relative);
  }
  Rendering r = slot.renderer.render_proxy(body.view, configuration, body.probe, seen_velocity);
  Vec3 shared{};
  if (beside(slot).body != kNoBody) {
    // at most: min(bodies, 2) / 2 per Scene::update
    shared = slot.renderer.proxy().share_of_neighbour(r.force);
  }
  if (body.moved) {
    bring_to_scene(body.pose, r);
    shared = rotate(body.pose.rotation, shared);
  }
  r.body = slot.body;
  all.contact = r;
  reach_ = r.proxy - probe;
  all.wall_velocity = velocity - relative;
  react(slot, r.proxy, r.force - shared);
  if (shared != Vec3{}) {
    // at most: min(bodies, 2) / 2 per Scene::update
    react(beside(slot), r.proxy, shared);
  }
}

/// Where the proxy leaves a ridge with the probe deep below, it takes several ticks to reach the
/// probe or the surface in between. Until then the spring between the two remains: with at most the
/// force of the last tick, and near its direction, so that it pulls no probe back that has left the
/// surface.
[[gnu::noinline]] void Scene::fall(const Slot& slot, Vec3 probe) {
  const Proxy& proxy = slot.renderer.proxy();
  Rendering r;
  r.proxy = proxy.position();
  if (bodies_[slot.body].moved) {
    r.proxy = position_to_scene(pose_of(slot), r.proxy);
  }
  const Vec3 displacement = r.proxy - probe;
  const float distance = length(displacement);
  const float reach = length(reach_);
  if (ended_ || proxy.inside() ||
      !(dot(displacement, reach_) > kFallDirection * distance * reach)) {
    led_ = kMaxReachableBodies;
    return;
  }
  const float spring = distance < reach ? distance : reach;
  const float size = length(force_) * (spring / reach);
  r.in_contact = true;
  r.slipping = true;
  r.strength = 1.0F;
  r.penetration_m = distance;
  r.normal = normalized_or(displacement, {});
  r.force = size * r.normal;
  r.stored_energy = 0.5F * size * spring;
  r.body = slot.body;
  rendering_.contact = r;
  reach_ = spring * r.normal;
  react(slot, r.proxy, r.force);
}

/// Stores the reaction of the body: the opposite of a force at the proxy.
[[gnu::noinline]] void Scene::react(const Slot& slot, Vec3 proxy, Vec3 force) {
  const Vec3 arm = proxy - pose_of(slot).translation_m;
  rendering_.reactions[number_of(slot)] = {slot.body, -force, cross(arm, -force)};
}

[[gnu::noinline]] void Scene::render_paper(const Configuration& configuration, Vec3 probe) {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body != kNoBody) {
      // at most: min(bodies, kMaxReachableBodies) per Scene::render_paper
      render_paper_body(slot, configuration, probe);
    }
  }
}

[[gnu::noinline]] void Scene::render_paper_body(Slot& slot, const Configuration& configuration,
                                                Vec3 probe) {
  end_contact_of_a_jump(slot, configuration);
  SceneRendering& all = rendering_;
  const Body& body = bodies_[slot.body];
  Rendering r = Renderer::render_paper(body.view, configuration, body.probe);
  if (body.moved) {
    bring_to_scene(body.pose, r);
  }
  r.body = slot.body;
  slot.in_contact = r.in_contact;
  if (!r.in_contact) {
    return;
  }
  react(slot, r.proxy, r.force);
  const Rendering other = all.contact;
  const bool is_first = !other.in_contact;
  if (is_first || length_squared(r.force) > length_squared(other.force)) {
    all.contact = r;
    all.wall_velocity = body.moved ? -relative_velocity(body.pose, body.motion, probe, {}) : Vec3{};
  }
  if (!is_first) {  // adding 0 would turn -0 into +0
    all.contact.force = r.force + other.force;
    all.contact.stored_energy = r.stored_energy + other.stored_energy;
  }
}

void Scene::move_on(float period_s) {
  for (std::uint32_t i = 0; i < count_; ++i) {  // bound: listed
    Body& body = bodies_[listed_[i]];
    body.last_probe = body.probe;
    body.seen = body.enabled;
    if (body.moved) {
      body.pose = advanced(body.pose, body.motion, period_s);
    }
  }
}

}  // namespace tactree::core
