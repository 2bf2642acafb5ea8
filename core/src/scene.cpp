// memory: RAM

#include "tactree/core/scene.hpp"

namespace tactree::core {
namespace {

constexpr const char* kWords[] = {
    "ok",
    "the controller is armed: stop first",
    "the controller is not configured",
    "there is no model",
    "the blob was built without the guarantees that surface mode needs",
    "a ball of the model may hold more points than the controller has room for",
    "a material is stiffer than device, hand and rate allow",
    "there is no room for another body",
    "there is no body of this number",
    "the pose is not finite, not a rotation, or beyond +-10 m",
    "the motion is not finite, or beyond 10 m/s or 100 rad/s",
    "a tick with this model may take longer than the rate allows",
};
constexpr std::uint32_t kWordCount = sizeof(kWords) / sizeof(kWords[0]);

/// Does the way from `a` to `b` come within `margin` of the interval?
bool touches(float a, float b, float low, float high, float margin) {
  return (a < b ? a : b) <= high + margin && (a < b ? b : a) >= low - margin;
}

/// Does it come near the model? The box of the way, not only its end, so that nothing is crossed
/// unnoticed between two ticks.
bool comes_near(const BlobView& view, Vec3 from, Vec3 to) {
  const BlobHeader& h = view.header();
  const float margin = h.reach_m + h.aabb_edge_m;  // memory: flash
  // memory: flash
  return touches(from.x, to.x, h.bounds_min_m[0], h.bounds_max_m[0], margin) &&
         touches(from.y, to.y, h.bounds_min_m[1], h.bounds_max_m[1], margin) &&
         touches(from.z, to.z, h.bounds_min_m[2], h.bounds_max_m[2], margin);
}

void bring_to_scene(const Pose& pose, Rendering& r) {
  r.proxy = position_to_scene(pose, r.proxy);
  r.normal = direction_to_scene(pose, r.normal);
  r.force = direction_to_scene(pose, r.force);
}

}  // namespace

const char* describe(ModelStatus status) {
  const auto index = static_cast<std::uint32_t>(status);
  return index < kWordCount ? kWords[index] : "unknown status";
}

void Scene::clear() {
  for (Body& body : bodies_) {  // bound: kMaxBodies
    body = {};
  }
  end_ = 0;
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
  body.moved = !(body.pose == Pose{});
  number = free;
  end_ = free < end_ ? end_ : free + 1U;
  return ModelStatus::kOk;
}

ModelStatus Scene::remove(std::uint32_t number) {
  if (!exists(number)) {
    return ModelStatus::kNoSuchBody;
  }
  release(number);
  bodies_[number] = {};
  while (end_ > 0U && !exists(end_ - 1U)) {  // bound: kMaxBodies
    --end_;
  }
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
  body.moved = !(body.pose == Pose{} && motion == Motion{});
  return ModelStatus::kOk;
}

bool Scene::exists(std::uint32_t number) const {
  return number < kMaxBodies && !bodies_[number].view.empty();
}

bool Scene::empty() const {
  bool none = true;
  for (const Body& body : bodies_) {  // bound: kMaxBodies
    none = none && body.view.empty();
  }
  return none;
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
    const bool lent = slot.body != kNoBody;
    lend(slot, slot.body, lent ? position_to_body(bodies_[slot.body].pose, probe) : probe);
    slot.fade.stop();
  }
  rendering_ = SceneRendering{};
}

void Scene::lend(Slot& slot, std::uint32_t number, Vec3 probe) {
  slot.body = number;
  slot.renderer.reset(probe);
  slot.in_contact = false;
  slot.force = {};
}

Scene::Slot* Scene::slot_of(std::uint32_t number) {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body == number) {
      return &slot;
    }
  }
  return nullptr;
}

/// One that is lent to nobody, or to a body which can do without it.
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

void Scene::let_go(Slot& slot, std::uint32_t fade_ticks) {
  if (slot.in_contact) {
    slot.fade.begin(slot.force, fade_ticks);
  }
}

void Scene::release(std::uint32_t number) {
  Slot* const slot = slot_of(number);
  if (slot != nullptr) {
    let_go(*slot, fade_ticks_);
    lend(*slot, kNoBody, {});
  }
}

void Scene::locate_probe(Vec3 probe) {
  for (std::uint32_t i = 0; i < end_; ++i) {  // bound: kMaxBodies
    Body& body = bodies_[i];
    if (!body.view.empty() && body.enabled) {
      // at most: bodies per Scene::locate_probe
      body.probe = body.moved ? position_to_body(body.pose, probe) : probe;
      body.last_probe = body.seen ? body.last_probe : body.probe;
    }
  }
}

/// A slot for each body within reach; and, while there are enough, for the others. True: there are
/// not enough. A proxy starts where the probe was in the last tick, which was still out of reach.
bool Scene::lend_slots() {
  bool within_reach[kMaxBodies] = {};
  for (std::uint32_t i = 0; i < end_; ++i) {  // bound: kMaxBodies
    const Body& body = bodies_[i];
    if (!body.view.empty() && body.enabled) {
      // at most: bodies per Scene::lend_slots
      within_reach[i] = comes_near(body.view, body.last_probe, body.probe);
    }
  }
  bool crowded = false;
  for (std::uint32_t i = 0; i < end_; ++i) {  // bound: kMaxBodies
    const Body& body = bodies_[i];
    if (body.view.empty() || !body.enabled || slot_of(i) != nullptr) {
      continue;
    }
    // at most: bodies per Scene::lend_slots
    Slot* const slot = within_reach[i] ? free_slot(within_reach) : slot_of(kNoBody);
    if (slot != nullptr) {
      lend(*slot, i, body.last_probe);  // at most: bodies per Scene::lend_slots
    }
    crowded = crowded || (within_reach[i] && slot == nullptr);
  }
  return crowded;
}

void Scene::let_out() {
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body != kNoBody) {
      slot.renderer.let_out(bodies_[slot.body].probe);
    }
  }
}

const SceneRendering& Scene::update(const Configuration& configuration, Vec3 probe, Vec3 velocity) {
  const auto fade_ticks = static_cast<std::uint32_t>(kFadeSeconds * configuration.rate_hz);
  fade_ticks_ = fade_ticks > 0U ? fade_ticks : 1U;
  SceneRendering& all = rendering_;
  all.contact.body = kNoBody;
  all.wall_velocity = {};
  all.fading = false;
  for (Reaction& reaction : all.reactions) {  // bound: kMaxReachableBodies
    reaction.body = kNoBody;
  }
  locate_probe(probe);
  all.crowded = lend_slots();
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.body != kNoBody) {
      // at most: min(bodies, kMaxReachableBodies) per Scene::update together contacts
      render(slot, configuration, probe, velocity);
    }
  }
  if (all.contact.body == kNoBody) {
    // at most: min(bodies, kMaxReachableBodies) per Scene::update together contacts
    all.contact = Rendering{};
    all.contact.proxy = probe;
  }
  // Adding nothing must not change the bits of a force, nor the sign of a zero.
  for (std::uint32_t i = 0; i < kMaxReachableBodies; ++i) {  // bound: kMaxReachableBodies
    const Slot& slot = slots_[i];
    if (slot.in_contact && slot.body != all.contact.body) {
      all.contact.force += slot.force;
      all.contact.stored_energy += slot.stored_energy;
    }
  }
  for (Slot& slot : slots_) {  // bound: kMaxReachableBodies
    if (slot.fade.active()) {
      all.contact.force += slot.fade.next();
      all.fading = true;
    }
  }
  move_on(1.0F / configuration.rate_hz);
  return all;
}

void Scene::render(Slot& slot, const Configuration& configuration, Vec3 probe, Vec3 velocity) {
  SceneRendering& all = rendering_;
  const Body& body = bodies_[slot.body];
  const float furthest = 2.0F * configuration.speed_max_m_s / configuration.rate_hz;
  if (!(length_squared(body.probe - body.last_probe) <= furthest * furthest)) {
    let_go(slot, fade_ticks_);
    lend(slot, slot.body, body.probe);
  }
  Vec3 relative = velocity;
  Vec3 seen_velocity = velocity;
  if (body.moved) {
    relative = relative_velocity(body.pose, body.motion, probe, velocity);
    seen_velocity = direction_to_body(body.pose, relative);
  }
  Rendering r = slot.renderer.update(body.view, configuration, body.probe, seen_velocity);
  if (body.moved) {
    bring_to_scene(body.pose, r);
  }
  r.body = slot.body;
  if (r.lost) {
    slot.fade.begin(slot.force - r.force, fade_ticks_);
  }
  slot.in_contact = r.in_contact;
  slot.force = r.force;
  slot.stored_energy = r.stored_energy;
  const bool first = all.contact.body == kNoBody;
  const bool complete = r.complete && (first || all.contact.complete);
  if (first || length_squared(r.force) > length_squared(all.contact.force)) {
    all.contact = r;
    all.wall_velocity = velocity - relative;
  }
  all.contact.complete = complete;
  if (r.in_contact) {
    const auto index = static_cast<std::uint32_t>(&slot - slots_);
    const Vec3 arm = r.proxy - body.pose.translation_m;
    all.reactions[index] = {slot.body, -r.force, cross(arm, -r.force)};
  }
}

void Scene::move_on(float period_s) {
  for (std::uint32_t i = 0; i < end_; ++i) {  // bound: kMaxBodies
    Body& body = bodies_[i];
    body.last_probe = body.probe;
    body.seen = body.enabled;
    if (body.moved) {
      body.pose = advanced(body.pose, body.motion, period_s);  // at most: bodies per Scene::move_on
    }
  }
}

}  // namespace tactree::core
