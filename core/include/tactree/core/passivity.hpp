#pragma once
// A sampled wall gives back more energy than was put in: it holds an old force while the hand moves
// on, K v^2 T / 2 a second. This observer counts what the wall gives beyond what its spring stores,
// and the controller takes it out again by damping, as much as needed and no more.
// (Hannaford and Ryu, "Time-domain passivity control of haptic interfaces", IEEE T-RA 18(1), 2002;
// measured against the spring's energy, so that what pressing stored does not hide a leak: after
// Ryu, Preusche, Hannaford and Hirzinger, "Time domain passivity control with reference energy
// following", IEEE T-CST 13(5), 2005.)
//
// Interrupt safe: no shared state.

#include <cstdint>

#include "tactree/core/vec3.hpp"

namespace tactree::core {

/// Of the probe and of the wall that it touches. What a wall gives because it moves is no leak.
struct WallMotion {
  Vec3 probe{};     ///< m, where the probe is now
  Vec3 velocity{};  ///< m/s, of the probe as estimated: an encoder that toggles is no motion
  Vec3 wall{};      ///< m/s, of the wall where the probe is
};

class PassivityController {
 public:
  /// period_s > 0: of a tick; damping_max_Ns_m >= 0: most that it may add; delay_s >= 0: from a
  /// reading to its force at the hand, beyond the sampling; of more than kHistory - 1 ticks the
  /// rest does not count.
  void configure(float period_s, float damping_max_Ns_m, float delay_s);

  /// Forgets; call it when there is no contact.
  void reset();
  /// What the spring holds (J, as in update()) it may give, though the hand did not put it in:
  /// while the force ramps, and when somebody put the wall elsewhere or made it another one.
  void allow(float stored);

  /// The force to add in this tick, N; against the motion, and zero while the wall gives nothing.
  ///   shown   N, the force that was sent in the last tick
  ///   stored  J, what the wall's spring holds for this place of the probe
  /// Cost: constant, about 30 operations.
  [[nodiscard]] Vec3 update(Vec3 shown, const WallMotion& motion, float stored);

  /// The push, N, that the wall can still take back while the hand leaves it at `speed_m_s` > 0:
  /// where the spring's force falls faster than slew_N_s, stiffness * speed > slew, what is shown
  /// lags behind and goes on giving until it is gone; more than the wall got it must not give.
  ///   F (F / 2 slew + delay) speed <= taken
  /// It got what was taken since contact began, and what allow() says.
  /// Cost: a division and a square root.
  [[nodiscard]] float most_push(float speed_m_s, float slew_N_s) const;

  /// Taken minus stored since contact began, J, at most 0: what was lost before does not count.
  [[nodiscard]] float balance() const { return balance_; }

  static constexpr std::uint32_t kHistory = 16;  ///< ticks of forces that may be on their way

 private:
  [[nodiscard]] Vec3 acted() const;

  float period_s_ = 1e-3F;
  float damping_max_ = 0.0F;
  float delay_s_ = 0.0F;
  float balance_ = 0.0F;
  float taken_ = 0.0F;  // J, what the wall got and did not give yet
  float stored_ = 0.0F;
  Vec3 last_{};
  Vec3 sent_[kHistory]{};  // the last one at newest_
  std::uint32_t newest_ = 0;
  std::uint32_t whole_ticks_ = 0;  // of the delay
  float rest_ = 0.0F;              // share of a tick
  bool following_ = false;         // last_ and stored_ hold
};

}  // namespace tactree::core
