#pragma once
// Time-domain passivity control of the wall. A sampled wall holds an old force while the hand moves
// and generates K v^2 T / 2 of energy a second. The observer measures the energy released beyond
// the energy stored in the spring; the controller absorbs it by damping.
// (Hannaford and Ryu, "Time-domain passivity control of haptic interfaces", IEEE T-RA 18(1), 2002;
// with the spring's energy as reference, so that stored energy does not mask a leak: after
// Ryu, Preusche, Hannaford and Hirzinger, "Time domain passivity control with reference energy
// following", IEEE T-CST 13(5), 2005.)
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::core {

/// Motion of the probe and of the wall that it touches. Work of a moving wall is not a leak.
struct WallMotion {
  Vec3 probe{};     ///< m, position of the probe
  Vec3 velocity{};  ///< m/s, estimate; not affected by a toggling encoder
  Vec3 wall{};      ///< m/s, of the wall at the probe
};

class PassivityController {
 public:
  /// period_s > 0: period of a tick. damping_max_Ns_m >= 0: maximum added damping. delay_s >= 0:
  /// from a reading to its force at the hand, beyond the sampling; limited to kMaxDelayTicks.
  void configure(float period_s, float damping_max_Ns_m, float delay_s);

  /// Clears all energies. Call it while there is no contact.
  void reset();
  /// Allows the spring to release `stored` (J, as in update()) although the hand did not supply it:
  /// while the force ramps, and when the application moves or changes the wall.
  void allow(float stored);

  /// Force to add in this tick, N, against the motion; zero while the wall releases no energy.
  ///   applied_force  N, output of the last tick
  ///   stored         J, energy of the wall's spring at this position of the probe
  /// Cost: constant, about 30 operations.
  [[nodiscard]] Vec3 update(Vec3 applied_force, const WallMotion& motion, float stored);

  /// Maximum push, N, on a hand that leaves the wall at `speed_m_s` > 0. If the spring's force
  /// falls faster than slew_N_s (stiffness * speed > slew), the applied force lags and releases
  /// energy until it is zero. The limit keeps this energy within the absorbed energy:
  ///   F (F / 2 slew + delay) speed <= absorbed
  /// absorbed: energy that the wall has absorbed since contact began, at least that of allow().
  /// Cost: a division and a square root.
  [[nodiscard]] float most_push(float speed_m_s, float slew_N_s) const;

  /// Absorbed minus stored energy since contact began, J, <= 0: earlier losses are not credited.
  [[nodiscard]] float observed_energy() const { return observed_energy_; }

  /// Forces in transit, ticks. Each takes 12 bytes. A power of two: the index wraps without a
  /// division.
  static constexpr std::uint32_t kHistory = kMaxDelayTicks + 1U;

 private:
  [[nodiscard]] Vec3 acted() const;

  float period_s_ = 1e-3F;
  float damping_max_ = 0.0F;
  float delay_s_ = 0.0F;
  float observed_energy_ = 0.0F;
  float absorbed_energy_ = 0.0F;  // J, absorbed by the wall and not yet released
  float stored_ = 0.0F;
  Vec3 last_{};
  Vec3 sent_[kHistory]{};  // the last one at newest_
  std::uint32_t newest_ = 0;
  std::uint32_t whole_ticks_ = 0;  // of the delay
  float rest_ = 0.0F;              // fraction of a tick
  bool following_ = false;         // last_ and stored_ are valid
};

}  // namespace tactree::core
