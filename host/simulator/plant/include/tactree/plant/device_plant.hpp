#pragma once
// Mechanics of a device with joints and of the hand at its tip.
//
// The model includes a rigid linkage whose joints carry constant inertias (links and motors, as
// seen at the joint), a point mass at the tip (device and hand), the weight of links and tip,
// viscous and dry friction in the joints, and inelastic stops at the ends of the joint ranges. It
// does not include the elasticity of cables and links, backlash, cogging, or the dependence of a
// link's inertia on the other joints.
//
// A sub-step accelerates joints and tip as free bodies and then projects their motion onto the
// linkage with the smallest change of kinetic energy (Gauss's principle of least constraint). This
// includes centrifugal and Coriolis effects and never adds energy. The same inputs give the same
// motion on every computer, because the plant uses double precision, fixed sub-steps, and only
// those functions of libm whose results are exact or correctly rounded, such as the square root.

#include <Eigen/Core>

#include "tactree/core/configuration/device_presets.hpp"
#include "tactree/plant/linkage.hpp"
#include "tactree/plant/plant.hpp"

namespace tactree::plant {

struct DevicePlantParameters {
  core::DeviceModel model{};
  core::DeviceDynamics dynamics{};  ///< inertia 1e-9 .. 1000, frictions 0 .. 1000
  HandParameters hand{};
  double substep_s = 5e-5;  ///< maximum sub-step: 1e-7 .. 1e-3
  bool has_weight = false;  ///< gravity acts on links and tip
};

/// Throws std::invalid_argument with the name of the field that is out of range.
void check(const DevicePlantParameters& parameters);

class DevicePlant {
 public:
  /// Starts at rest with the tip at the reachable position nearest to `start_m` (device frame).
  /// Throws like check().
  DevicePlant(const DevicePlantParameters& parameters, const Eigen::Vector3d& start_m);

  /// Advances by `duration_s` under constant motor efforts, N or Nm. Meanwhile the target moves at
  /// its velocity.
  void advance(const Eigen::Vector3d& effort, const HandTarget& target, double duration_s);

  [[nodiscard]] const Eigen::Vector3d& joints() const { return joints_; }
  [[nodiscard]] const Eigen::Vector3d& position_m() const { return pose_.tip_m; }
  [[nodiscard]] const Eigen::Vector3d& velocity_m_s() const { return tip_velocity_; }
  /// Energy balance: kinetic + potential - initial = motor + hand - friction. It is exact except
  /// for the potential energy, whose error is of the order of the sub-step.
  [[nodiscard]] const Energy& energy() const { return energy_; }
  [[nodiscard]] double kinetic_J() const;
  [[nodiscard]] double potential_J() const;
  [[nodiscard]] const Linkage& linkage() const { return linkage_; }

 private:
  void substep(const Eigen::Vector3d& effort, const HandTarget& target, double dt);
  void rub(const Eigen::Matrix3d& inverse_mass, double dt);
  void move(double dt);
  [[nodiscard]] Eigen::Vector3d link_weight() const;

  DevicePlantParameters parameters_;
  Linkage linkage_;
  Eigen::Vector3d inertia_;
  Eigen::Vector3d viscous_;
  Eigen::Vector3d coulomb_;
  double tip_mass_;  // of device and hand
  Eigen::Vector3d joints_;
  LinkagePose pose_{};
  Eigen::Vector3d joint_velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_velocity_ = Eigen::Vector3d::Zero();
  Energy energy_{};
};

}  // namespace tactree::plant
