// Which bodies the probe reaches, the renderer of each, and the sum of their forces.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/scene.hpp"

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
    "there is no body of this number",
    "the pose is not finite, not a rotation, or beyond +-10 m",
    "the motion is not finite, or beyond 10 m/s or 100 rad/s",
    "a tick with this model may take longer than the rate allows",
};
constexpr std::uint32_t kDescriptionCount = sizeof(kDescriptions) / sizeof(kDescriptions[0]);

/// Does the path from `a` to `b` come within `margin` of the interval?
bool touches(float a, float b, float low, float high, float margin) {
  return (a < b ? a : b) <= high + margin && (a < b ? b : a) >= low - margin;
}

/// Does the path come near the model? Its whole box is compared, not only its end: a fast probe
/// would cross a thin model between two ticks.
bool comes_near(const BlobView& view, Vec3 from, Vec3 to) {
  const BlobHeader& h = view.header();
  const float margin = h.reach_m + h.aabb_edge_m;  // memory: flash
  // memory: flash
  return touches(from.x, to.x, h.bounds_min_m[0], h.bounds_max_m[0], margin) &&
         touches(from.y, to.y, h.bounds_min_m[1], h.bounds_max_m[1], margin) &&
         touches(from.z, to.z, h.bounds_min_m[2], h.bounds_max_m[2], margin);
}

void bring_to_scene(const Pose& pose, Rendering& r) {
  if (pose == Pose{}) {
    return;
  }
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
  body.moved = !(body.pose == Pose{});
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
  body.moved = !(body.pose == Pose{} && motion == Motion{});
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
    assign_slot(slot, slot.body,
                assigned ? position_to_body(bodies_[slot.body].pose, probe) : probe);
    slot.fade.stop();
  }
  rendering_ = SceneRendering{};
}

void Scene::assign_slot(Slot& slot, std::uint32_t number, Vec3 probe) {
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

/// An unassigned slot, or one of a body out of reach and contact; null: none.
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

void Scene::begin_fade(Slot& slot, std::uint32_t fade_ticks) {
  if (slot.in_contact) {
    slot.fade.begin(slot.force, fade_ticks);
  }
}

void Scene::release(std::uint32_t number) {
  Slot* const slot = slot_of(number);
  if (slot != nullptr) {
    begin_fade(*slot, fade_ticks_);
    assign_slot(*slot, kNoBody, {});
  }
}

void Scene::locate_probe(Vec3 probe) {
  for (std::uint32_t i = 0; i < count_; ++i) {  // bound: listed
    Body& body = bodies_[listed_[i]];
    if (body.enabled) {
      body.probe = body.moved ? position_to_body(body.pose, probe) : probe;
      body.last_probe = body.seen ? body.last_probe : body.probe;
    }
  }
}

/// Assigns slots to the bodies within reach, then to the others. True: a body within reach got
/// none. A proxy starts at the probe's last position, which was still out of reach.
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
  const auto fade_ticks = static_cast<std::uint32_t>(kFadeSeconds * configuration.rate_hz);
  fade_ticks_ = fade_ticks > 0U ? fade_ticks : 1U;
  SceneRendering& all = rendering_;
  all.contact.body = kNoBody;
  all.wall_velocity = {};
  all.fading = false;
  all.inside = false;
  for (Reaction& reaction : all.reactions) {  // bound: kMaxReachableBodies
    reaction.body = kNoBody;
  }
  locate_probe(probe);
  all.crowded = assign_slots();
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
  // No addition without a second contact: adding 0 would change the sign of a zero.
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
    begin_fade(slot, fade_ticks_);
    assign_slot(slot, slot.body, body.probe);
  }
  Vec3 relative = velocity;
  Vec3 seen_velocity = velocity;
  if (body.moved) {
    relative = relative_velocity(body.pose, body.motion, probe, velocity);
    seen_velocity = direction_to_body(body.pose, relative);
  }
  Rendering r =
      slot.renderer.update(body.view, configuration, body.probe, seen_velocity, work_tier_);
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
  all.inside = all.inside || r.inside;
  if (r.in_contact) {
    const auto index = static_cast<std::uint32_t>(&slot - slots_);
    const Vec3 arm = r.proxy - body.pose.translation_m;
    all.reactions[index] = {slot.body, -r.force, cross(arm, -r.force)};
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
