#pragma once
// Several rigid bodies around one probe. Each body has a model and a pose that may change every
// tick. A Renderer per body works in the body's frame: a moving body carries its proxy along and
// pushes the probe. The probe feels the surface of the union of the bodies: one proxy is held by
// the faces of all, and a face inside another body is not felt (neighbour.hpp). The material is
// that of the leading body. In paper mode the forces of the bodies are added.
//
//   probe -> bodies within reach -> body frame -> proxies, of which one leads -> force and
//   reactions on the bodies
//
// At most kMaxReachableBodies of the bodies whose box contains the probe are rendered: those
// reached first, then those with the lowest numbers. The others exert no force, and
// SceneRendering::crowded is set. A body that appears around the probe exerts no force until the
// probe has left it, and SceneRendering::inside is set; a sheet that appears is felt from the
// probe's side.
//
// Interrupt safety: no shared state; one context owns a scene.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/force_fade.hpp"
#include "tactree/core/contact/renderer.hpp"
#include "tactree/core/math/pose.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// Each body takes about 100 operations per tick, even out of reach (TickCosts::listed).
inline constexpr std::uint32_t kMaxBodies = 8;
/// Rendered in one tick; bounds its work. Each takes the gathers and fits of a tick, and 3.5 KiB of
/// RAM for its candidates. Scene::beside() assumes two.
inline constexpr std::uint32_t kMaxReachableBodies = 2;

/// Time in which the force of a removed contact fades to 0: 8 N by 0.16 N per tick at 1 kHz.
/// Without it, only the slew limit of the gate would act, which by default ends 8 N within 4 ms. A
/// longer fade pushes the hand for that time where there is no surface.
inline constexpr float kFadeSeconds = 0.05F;

/// Reason why a model or a change of a body was refused.
enum class ModelStatus : std::uint8_t {
  kOk = 0,
  kBusy,           ///< armed or active: stop first
  kNotConfigured,  ///< configure() first
  kEmpty,          ///< no model in the view
  kNoReach,        ///< built without the guarantees that surface mode needs
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points
  kTooStiff,       ///< a material is stiffer than material_limit(): see find_unstable_material()
  kTooManyBodies,  ///< the scene already has kMaxBodies
  kNoSuchBody,     ///< nothing was added under this number, or it was removed
  kBadPose,        ///< is_valid(Pose) is false
  kBadMotion,      ///< is_valid(Motion) is false
  kTooSlow,        ///< a tick with it may take longer than the rate allows: see tick_cost.hpp
};
[[nodiscard]] const char* describe(ModelStatus status);

/// Force and torque of the probe on a body, along the scene's axes; torque about the body's origin.
struct Reaction {
  std::uint32_t body = kNoBody;
  Vec3 force_N{};
  Vec3 torque_Nm{};
};

/// Contacts of all bodies in one tick.
struct SceneRendering {
  /// The contact of the leading body, in paper mode the one with the largest force, in the scene's
  /// frame. `force` and `stored_energy` cover all bodies.
  Rendering contact{};
  Vec3 wall_velocity{};                       ///< m/s, of the body in contact, at the probe
  Reaction reactions[kMaxReachableBodies]{};  ///< of the bodies in contact
  bool crowded = false;                       ///< more bodies within reach than kMaxReachableBodies
  bool fading = false;                        ///< the force of a removed contact fades
  bool inside = false;                        ///< the probe is in the material of a body
};

class Scene {
 public:
  /// Removes all bodies, contacts and forces.
  void clear();

  /// Adds a body; `number` receives the lowest free number. The model must outlive the body and
  /// suit the render mode: surface_support(). Errors: kEmpty, kBadPose, kTooManyBodies.
  [[nodiscard]] ModelStatus add(const BlobView& view, const Pose& pose, std::uint32_t& number);
  /// Removes a body; its force fades. Its blob is not read after the call. Error: kNoSuchBody.
  [[nodiscard]] ModelStatus remove(std::uint32_t number);
  /// A disabled body exerts no force, but keeps its number and continues to move. Error:
  /// kNoSuchBody.
  [[nodiscard]] ModelStatus enable(std::uint32_t number, bool enabled);
  /// Places a body at `pose` in the next tick; from there it moves with `motion`. If the probe
  /// jumps in the body's frame faster than twice speed_max_m_s, the contact ends and its force
  /// fades. Errors: kNoSuchBody, kBadPose, kBadMotion.
  [[nodiscard]] ModelStatus move(std::uint32_t number, const Pose& pose, const Motion& motion);

  [[nodiscard]] bool empty() const { return count_ == 0U; }
  /// Returns an empty view if there is no such body.
  [[nodiscard]] BlobView view(std::uint32_t number) const;
  /// Returns the pose at the origin if there is no such body.
  [[nodiscard]] Pose pose(std::uint32_t number) const;

  /// Clears contacts and fading forces, not bodies. Required when the probe jumps.
  void reset(Vec3 probe);

  /// Clears contacts with the backs of sheets, so that the probe can change sides. Call it before
  /// update(), while no force is displayed.
  void release_backs();

  /// Limits the work of each body in a tick to that of this tier, if the tier of the rate allows
  /// more. Initially 0: the rate alone decides. Precondition: work_tier < kWorkTiers.
  void limit_work(std::uint32_t work_tier) { work_tier_ = work_tier; }
  [[nodiscard]] std::uint32_t work_tier() const { return work_tier_; }

  /// Renders one tick; `probe` (m) and `velocity` (m/s) in the scene's frame. Preconditions:
  /// check(configuration) is kOk, `probe` is finite.
  /// Cost: kMaxReachableBodies times Proxy::update(), one force, kMaxBodies times about 100
  /// operations.
  const SceneRendering& update(const Configuration& configuration, Vec3 probe, Vec3 velocity);
  /// Result of the last update(); no contact after reset().
  [[nodiscard]] const SceneRendering& rendering() const { return rendering_; }

 private:
  struct Body {
    BlobView view{};  // empty: the number is free, and all other members have their defaults
    Pose pose{};
    Motion motion{};
    Vec3 probe{};        // in the body's frame, this tick; valid if enabled
    Vec3 last_probe{};   // in the body's frame, last tick; valid if seen
    bool moved = false;  // the body's frame differs from the scene's, or will
    bool enabled = true;
    bool seen = false;
  };

  /// A renderer and the body it is assigned to.
  struct Slot {
    std::uint32_t body = kNoBody;
    bool in_contact = false;
    Renderer renderer{};
  };

  [[nodiscard]] bool exists(std::uint32_t number) const;
  [[nodiscard]] Slot* slot_of(std::uint32_t number);
  [[nodiscard]] Slot* free_slot(const bool (&within_reach)[kMaxBodies]);
  void assign_slot(Slot& slot, std::uint32_t number, Vec3 probe);
  void release(std::uint32_t number);
  void locate_probe(Vec3 probe);
  [[nodiscard]] bool assign_slots();
  [[nodiscard]] Slot* leading();
  [[nodiscard]] std::uint32_t number_of(const Slot& slot) const {
    return static_cast<std::uint32_t>(&slot - slots_);
  }
  [[nodiscard]] Slot& beside(const Slot& slot) { return slots_[&slot == slots_ ? 1 : 0]; }
  [[nodiscard]] const Pose& pose_of(const Slot& slot) const { return bodies_[slot.body].pose; }
  [[nodiscard]] Neighbour neighbour_of(const Slot& slot, const Slot& other) const;
  void end_contact_of_a_jump(Slot& slot, const Configuration& configuration);
  [[nodiscard]] Slot* track_all(const Configuration& configuration);
  void track(Slot& slot, const Configuration& configuration);
  [[nodiscard]] Slot* share(Slot& leader);
  [[nodiscard]] bool observe();
  void render(Slot& slot, const Configuration& configuration, Vec3 probe, Vec3 velocity);
  void fall(const Slot& slot, Vec3 probe);
  void react(const Slot& slot, Vec3 proxy, Vec3 force);
  void render_paper(const Configuration& configuration, Vec3 probe);
  void render_paper_body(Slot& slot, const Configuration& configuration, Vec3 probe);
  void move_on(float period_s);
  void list_bodies();

  // Large members last: the offsets of the others fit into the immediate of a load or store.
  std::uint8_t listed_[kMaxBodies]{};  // numbers of the bodies, ascending
  std::uint32_t count_ = 0;            // number of bodies
  SceneRendering rendering_{};
  Neighbour neighbour_{};  // of the body that is tracked
  Vec3 force_{};           // of the contacts in the last tick
  Vec3 reach_{};           // m, the spring of force_: from the probe to the proxy
  // Slot that led in the last tick, or whose proxy fell; kMaxReachableBodies: none
  std::uint32_t led_ = kMaxReachableBodies;
  ForceFade fade_{};
  bool ended_ = false;           // a contact ended, but not because the probe left: its force fades
  std::uint32_t work_tier_ = 0;  // minimum at any rate
  Body bodies_[kMaxBodies]{};
  Slot slots_[kMaxReachableBodies]{};
};

}  // namespace tactree::core
