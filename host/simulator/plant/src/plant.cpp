#include "tactree/plant/plant.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace tactree::plant {
namespace {

void require(double value, double low, double high, const char* field) {
  if (!(value >= low && value <= high)) {
    throw std::invalid_argument(std::string(field) + " is out of range");
  }
}

/// Velocity after dry friction, which reduces the speed by at most `loss`; it stops an axis and
/// never reverses it.
double rub_off(double velocity, double loss) {
  return std::abs(velocity) <= loss ? 0.0 : velocity - std::copysign(loss, velocity);
}

}  // namespace

void check(const PlantParameters& p) {
  require(p.device.mass_kg, 1e-4, 100.0, "device.mass_kg");
  require(p.device.viscous_Ns_m, 0.0, 1e3, "device.viscous_Ns_m");
  require(p.device.coulomb_N, 0.0, 100.0, "device.coulomb_N");
  require(p.hand.mass_kg, 0.0, 100.0, "hand.mass_kg");
  require(p.hand.stiffness_N_m, 0.0, 1e5, "hand.stiffness_N_m");
  require(p.hand.damping_Ns_m, 0.0, 1e3, "hand.damping_Ns_m");
  require(p.substep_s, 1e-7, 1e-3, "substep_s");
}

Plant::Plant(const PlantParameters& parameters, const Eigen::Vector3d& start_m)
    : parameters_(parameters), position_(start_m) {
  check(parameters);
}

void Plant::advance(const Eigen::Vector3d& motor_N, const HandTarget& target, double duration_s) {
  const double steps = std::max(1.0, std::ceil(duration_s / parameters_.substep_s));
  const double dt = duration_s / steps;
  HandTarget now = target;
  for (double i = 0.0; i < steps; i += 1.0) {
    now.position_m = target.position_m + (i + 1.0) * dt * target.velocity_m_s;
    substep(motor_N, now, dt);
  }
}

double Plant::kinetic_J() const {
  return 0.5 * (parameters_.device.mass_kg + parameters_.hand.mass_kg) * velocity_.squaredNorm();
}

void Plant::substep(const Eigen::Vector3d& motor_N, const HandTarget& target, double dt) {
  const DeviceParameters& device = parameters_.device;
  const HandParameters& hand = parameters_.hand;
  const double mass = device.mass_kg + hand.mass_kg;
  const Eigen::Vector3d hand_N = hand.stiffness_N_m * (target.position_m - position_) +
                                 hand.damping_Ns_m * (target.velocity_m_s - velocity_);
  const Eigen::Vector3d before = velocity_;
  velocity_ += dt / mass * (motor_N + hand_N);
  const Eigen::Vector3d pushed = velocity_;
  // The implicit step is stable for every damping and sub-step.
  velocity_ /= 1.0 + dt * device.viscous_Ns_m / mass;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    velocity_[axis] = rub_off(velocity_[axis], dt * device.coulomb_N / mass);
  }
  position_ += dt * velocity_;
  // The work of an impulse is its product with the mean of the velocities before and after it.
  energy_.motor += dt * motor_N.dot(0.5 * (before + pushed));
  energy_.hand += dt * hand_N.dot(0.5 * (before + pushed));
  energy_.friction += 0.5 * mass * (pushed.squaredNorm() - velocity_.squaredNorm());
}

}  // namespace tactree::plant
