#pragma once
// A controller with its simulated device and hand, as a page runs it.

#include <Eigen/Core>
#include <cstdint>
#include <memory>

#include "tactree/simulation/scene_target.hpp"
#include "tactree/simulation/simulation.hpp"
#include "tactree/viewer/frame.hpp"

namespace tactree::viewer {

class LiveRun {
 public:
  /// Starts disarmed, with device and hand at `at_m` (model frame), at this tick of the session.
  /// The blobs of `bodies` must outlive it.
  LiveRun(const Bodies& bodies, const simulation::Setup& setup, const Eigen::Vector3d& at_m,
          std::uint64_t tick);

  void arm();
  void stop();
  void clear();
  void mend() { sim_.injector().mend(sim_.time_s()); }
  void inject(simulation::InjectedFault fault);
  /// Takes over the injected faults, and arms the controller if the other one is wanted armed and
  /// has no fault. Returns true in this case.
  bool continue_from(const LiveRun& other);

  /// Changes contact, limits and use of materials while the session runs. The contact changes
  /// evenly within 0.1 s, because the force would jump otherwise. The rest requires the motors to
  /// be off: an active controller is stopped for it, and armed again. Returns true in this case.
  /// Precondition: `wanted` passes check() and differs in these groups only.
  bool change(const core::Configuration& wanted);

  /// Puts the first body at rest at `pose`; see SceneTarget::place().
  void place(const Eigen::Isometry3d& pose) { target_.place(0, pose); }

  /// Executes one tick.
  void step(const plant::HandTarget& hand);

  [[nodiscard]] const simulation::Simulation& simulation() const { return sim_; }
  [[nodiscard]] const core::Configuration& configuration() const { return configuration_; }
  [[nodiscard]] const simulation::Sample& last() const { return last_; }
  [[nodiscard]] Strip& strip() { return strip_; }
  /// Position of the device, model frame.
  [[nodiscard]] Eigen::Vector3d tip_m() const;

 private:
  LiveRun(const Bodies& bodies, const simulation::Setup& setup, const Eigen::Vector3d& at_m,
          std::uint64_t tick, std::unique_ptr<simulation::SceneTarget> target);
  void post(core::Command command);
  void adjust();
  [[nodiscard]] core::ContactParameters next_contact();

  core::Configuration configuration_;
  simulation::SceneTarget& target_;  // owned by sim_
  simulation::Simulation sim_;
  simulation::Sample last_{};
  Strip strip_;
  double hold_at_s_ = -1.0;  // time at which the hand presses the dead-man control; negative: never
  bool stop_next_ = false;
  bool is_wanted_ = false;  // armed by the hand and not stopped since

  // A change that is not complete yet.
  bool is_changing_ = false;
  bool arms_after_change_ = false;
  core::ContactParameters contact_before_{};
  double change_begin_s_ = 0.0;
};

}  // namespace tactree::viewer
