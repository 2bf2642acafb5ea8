#pragma once
// Computes the motor command from the rendered force: reach of the device, passivity, force of the
// application, SafetyGate.
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/control/passivity.hpp"
#include "tactree/core/control/probe_sensor.hpp"
#include "tactree/core/device/kinematics.hpp"
#include "tactree/core/safety/safety_gate.hpp"

namespace tactree::core {

/// A force of the application, N, added to the contact force. It acts for `ticks` ticks, at most
/// kAddedForceSeconds; the next added force replaces it, and leaving the active state ends it.
/// Scaled down to kAddedForceShare of force_max_N; ignored if not finite. The gate limits the sum.
struct AddedForce {
  Vec3 force_N{};
  std::uint32_t ticks = 0;  ///< 0: none
};

/// Maximum duration of an AddedForce. An application that hangs pushes the hand no longer, even if
/// link_required is false; it is also the maximum of link_timeout_s. The shorter it is, the more
/// often a lasting force must be sent again.
inline constexpr float kAddedForceSeconds = 0.1F;
/// Maximum ratio of an AddedForce to force_max_N. A contact that pushes with force_max_N keeps at
/// least half of it against the application; with 1, the application could cancel any contact.
inline constexpr float kAddedForceShare = 0.5F;

class ForceStage {
 public:
  /// Returns false and changes nothing if a limit is out of range.
  [[nodiscard]] bool set_limits(const Configuration& configuration);
  /// Precondition: check() accepts the configuration.
  void configure_passivity(const Configuration& configuration);

  /// Sets the force of the application. No effect if `added.ticks` is 0.
  void add(const AddedForce& added, const Configuration& configuration);
  /// Call when the application has changed the wall since the last tick: the spring of the wall may
  /// then release its stored energy.
  void allow_stored_energy() { wall_changed_ = true; }

  /// The command of an active tick. Cost: constant, about 500 instructions.
  [[nodiscard]] SafetyGate::Result apply(const Configuration& configuration,
                                         const ProbeSensor& sensor, const SceneRendering& scene);
  /// The zero command, for a tick that is not active. Ends the force of the application.
  [[nodiscard]] SafetyGate::Result release();

  /// Force applied in the last active tick, N.
  [[nodiscard]] Vec3 applied_force() const { return applied_force_; }
  /// Component of applied_force() that the application added, N.
  [[nodiscard]] Vec3 added_force() const { return added_force_; }

 private:
  [[nodiscard]] Vec3 contact_force(const Configuration& configuration, const ProbeSensor& sensor,
                                   const SceneRendering& scene);

  PassivityController passivity_{};
  SafetyGate gate_{};
  Vec3 applied_force_{};
  Vec3 added_force_{};
  Vec3 external_force_{};  // of the application, N, for external_ticks_ more ticks
  std::uint32_t external_ticks_ = 0;
  bool ramp_complete_ = false;  // the ramp did not limit the last force
  bool wall_changed_ = false;
};

}  // namespace tactree::core
