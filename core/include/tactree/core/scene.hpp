#pragma once
// Several rigid bodies around one probe. Each has a model and a pose that may change every tick;
// the probe is seen from the body's frame, and rendered there by a Renderer of its own, so that a
// body that moves takes its proxy along and pushes the probe. The forces add up.
//
//   probe -> bodies within reach -> body frame -> Renderer -> force, and its reaction on the body
//
// Of the bodies whose box the probe touches, kMaxReachableBodies are rendered: those touched first,
// then those added first. The others are as if they were not there, and SceneRendering tells so.
// A body that appears around the probe does not throw it out: its surface is felt from within.
//
// Interrupt safe: no shared state; one context owns a Scene.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/force_fade.hpp"
#include "tactree/core/pose.hpp"
#include "tactree/core/renderer.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kMaxBodies = 8;
inline constexpr std::uint32_t kMaxReachableBodies = 2;  ///< rendered at the same time

/// How long the force of a contact that disappears takes to fade.
inline constexpr float kFadeSeconds = 0.05F;

/// Why a model or a change of a body was refused.
enum class ModelStatus : std::uint8_t {
  kOk = 0,
  kBusy,           ///< armed or active: stop first
  kNotConfigured,  ///< configure() first
  kEmpty,          ///< no model in the view
  kNoReach,        ///< built without the guarantees that surface mode needs
  kTooManyPoints,  ///< a ball may hold more than kMaxCandidates points
  kTooStiff,       ///< a material is stiffer than material_limit(): see find_unstable_material()
  kTooManyBodies,  ///< there are kMaxBodies
  kNoSuchBody,     ///< nothing was added under this number, or it was removed
  kBadPose,        ///< is_valid(Pose) is false
  kBadMotion,      ///< is_valid(Motion) is false
  kTooSlow,        ///< a tick with it may take longer than the rate allows: see tick_cost.hpp
};
[[nodiscard]] const char* describe(ModelStatus status);

/// What the probe does to a body; scene's axes, the torque about the body's origin.
struct Reaction {
  std::uint32_t body = kNoBody;
  Vec3 force_N{};
  Vec3 torque_Nm{};
};

/// What the bodies do to the probe in one tick.
struct SceneRendering {
  /// The contact with the largest force, in the scene's frame; `force` and `stored_energy` are
  /// those of all of them.
  Rendering contact{};
  Vec3 wall_velocity{};                       ///< m/s, of that contact's body where the probe is
  Reaction reactions[kMaxReachableBodies]{};  ///< of the bodies in contact
  bool crowded = false;                       ///< more bodies within reach than kMaxReachableBodies
  bool fading = false;  ///< a contact has disappeared: its force is on its way to 0
};

class Scene {
 public:
  /// Takes all bodies out, and every force with them.
  void clear();

  /// Adds a body; `number` tells which. Its model must be suitable and outlive it.
  [[nodiscard]] ModelStatus add(const BlobView& view, const Pose& pose, std::uint32_t& number);
  /// Its force fades; its blob is not read any more. The number may be given to another body.
  [[nodiscard]] ModelStatus remove(std::uint32_t number);
  /// A body that is disabled is as if removed, but keeps its number, and moves on.
  [[nodiscard]] ModelStatus enable(std::uint32_t number, bool enabled);
  /// Puts a body at `pose` in the next tick; from there it moves on until told otherwise. Where it
  /// jumps by more than twice the probe's greatest speed, a contact ends: its force fades.
  [[nodiscard]] ModelStatus move(std::uint32_t number, const Pose& pose, const Motion& motion);

  [[nodiscard]] bool empty() const;
  /// The empty view where there is no such body.
  [[nodiscard]] BlobView view(std::uint32_t number) const;
  /// Likewise the pose at the origin.
  [[nodiscard]] Pose pose(std::uint32_t number) const;

  /// Forgets contacts and fading forces, not bodies: the probe is somewhere else now.
  void reset(Vec3 probe);

  /// While there is no force, before update(): who goes out of an object from within is outside,
  /// and not held at its inner side.
  void let_out();

  /// One tick; `probe` and `velocity` in the scene's frame. Preconditions: as Renderer::update().
  /// Cost: kMaxReachableBodies times Renderer::update(), kMaxBodies times about 100 operations.
  const SceneRendering& update(const Configuration& configuration, Vec3 probe, Vec3 velocity);
  /// What update() returned last; nothing after reset().
  [[nodiscard]] const SceneRendering& rendering() const { return rendering_; }

 private:
  struct Body {
    BlobView view{};  // empty: the number is free, and all the rest as here
    Pose pose{};
    Motion motion{};
    Vec3 probe{};        // in the body's frame, of this tick; where `enabled`
    Vec3 last_probe{};   // of the last tick; where `seen`
    bool moved = false;  // its frame is not the scene's, or will not be
    bool enabled = true;
    bool seen = false;
  };

  /// A renderer and the body it is lent to.
  struct Slot {
    std::uint32_t body = kNoBody;
    Renderer renderer{};
    bool in_contact = false;
    Vec3 force{};  // of the last tick
    float stored_energy = 0.0F;
    ForceFade fade{};
  };

  [[nodiscard]] bool exists(std::uint32_t number) const;
  [[nodiscard]] Slot* slot_of(std::uint32_t number);
  [[nodiscard]] Slot* free_slot(const bool (&within_reach)[kMaxBodies]);
  static void lend(Slot& slot, std::uint32_t number, Vec3 probe);
  void release(std::uint32_t number);
  static void let_go(Slot& slot, std::uint32_t fade_ticks);
  void locate_probe(Vec3 probe);
  [[nodiscard]] bool lend_slots();
  void render(Slot& slot, const Configuration& configuration, Vec3 probe, Vec3 velocity);
  void move_on(float period_s);

  Body bodies_[kMaxBodies]{};
  std::uint32_t end_ = 0;  // one behind the last body
  Slot slots_[kMaxReachableBodies]{};
  SceneRendering rendering_{};
  std::uint32_t fade_ticks_ = 1;
};

}  // namespace tactree::core
