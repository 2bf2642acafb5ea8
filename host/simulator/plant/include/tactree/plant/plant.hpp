#pragma once
// Mechanics that a controller drives: the moving mass of a device and the hand that holds it. The
// same inputs give the same motion: double precision, fixed sub-steps, no randomness.

#include <Eigen/Core>

namespace tactree::plant {

/// The device, with the same parameters on all three axes. The defaults are those of a device of
/// the PHANTOM Premium class.
struct DeviceParameters {
  double mass_kg = 0.075;      ///< apparent at the tip: 1e-4 .. 100
  double viscous_Ns_m = 0.05;  ///< 0 .. 1000
  double coulomb_N = 0.04;     ///< dry friction ("back-drive friction"): 0 .. 100
};

/// The hand, a mass that moves with the device and is drawn to a target by a spring and a damper.
/// The defaults are those of a relaxed grip with thumb and finger.
struct HandParameters {
  double mass_kg = 0.1;          ///< 0 .. 100
  double stiffness_N_m = 300.0;  ///< 0 .. 1e5
  double damping_Ns_m = 5.0;     ///< 0 .. 1000
};

struct PlantParameters {
  DeviceParameters device{};
  HandParameters hand{};
  double substep_s = 5e-5;  ///< maximum sub-step: 1e-7 .. 1e-3
};

/// Throws std::invalid_argument with the name of the field that is out of range.
void check(const PlantParameters& parameters);

/// Target of the hand's spring and damper.
struct HandTarget {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
};

/// Energy since the start, J. The increase of the kinetic energy equals motor + hand - friction,
/// within the integration error.
struct Energy {
  double motor = 0.0;     ///< supplied by the motors
  double hand = 0.0;      ///< supplied by the hand's spring and damper
  double friction = 0.0;  ///< dissipated in the device
};

class Plant {
 public:
  /// Starts at rest at `start_m`. Throws like check().
  Plant(const PlantParameters& parameters, const Eigen::Vector3d& start_m);

  /// Advances by `duration_s` under a constant motor force, N. Meanwhile the target moves at its
  /// velocity. Semi-implicit Euler in equal sub-steps; dry friction stops an axis exactly.
  void advance(const Eigen::Vector3d& motor_N, const HandTarget& target, double duration_s);

  [[nodiscard]] const Eigen::Vector3d& position_m() const { return position_; }
  [[nodiscard]] const Eigen::Vector3d& velocity_m_s() const { return velocity_; }
  [[nodiscard]] const Energy& energy() const { return energy_; }
  /// Kinetic energy of device and hand, J.
  [[nodiscard]] double kinetic_J() const;

 private:
  void substep(const Eigen::Vector3d& motor_N, const HandTarget& target, double dt);

  PlantParameters parameters_;
  Eigen::Vector3d position_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Energy energy_{};
};

}  // namespace tactree::plant
