#include "tactree/plant/device_plant.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace tactree::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Gauss-Seidel passes for dry friction and stops. One is not enough: the tip's mass couples the
// joints.
constexpr int kRubs = 12;

void require(bool valid, const std::string& field) {
  if (!valid) {
    throw std::invalid_argument(field + " is out of range");
  }
}

bool in_range(double value, double low, double high) { return value >= low && value <= high; }

Vector3d widen(const float (&v)[core::kAxes]) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

void check(const DevicePlantParameters& p) {
  require(core::is_valid(p.model), "device model");
  for (std::uint32_t i = 0; i < core::axes_of(p.model.kind); ++i) {
    const std::string axis = "[" + std::to_string(i) + "]";
    require(in_range(static_cast<double>(p.dynamics.inertia[i]), 1e-9, 1e3), "inertia" + axis);
    require(in_range(static_cast<double>(p.dynamics.viscous[i]), 0.0, 1e3), "viscous" + axis);
    require(in_range(static_cast<double>(p.dynamics.coulomb[i]), 0.0, 1e3), "coulomb" + axis);
  }
  check(PlantParameters{{}, p.hand, p.substep_s});
}

DevicePlant::DevicePlant(const DevicePlantParameters& parameters, const Vector3d& start_m)
    : parameters_(parameters),
      linkage_(parameters.model),
      inertia_(widen(parameters.dynamics.inertia)),
      viscous_(widen(parameters.dynamics.viscous)),
      coulomb_(widen(parameters.dynamics.coulomb)),
      tip_mass_(parameters.hand.mass_kg + static_cast<double>(parameters.model.tip_mass_kg)) {
  check(parameters);
  joints_ = linkage_.joints_near(start_m);
  const std::optional<LinkagePose> pose = linkage_.pose(joints_);
  require(pose.has_value(), "start of the tip");
  pose_ = *pose;
  for (Eigen::Index i = linkage_.axes(); i < 3; ++i) {
    inertia_[i] = 1.0;  // unused axis without effort; keeps the mass matrix invertible
  }
}

void DevicePlant::advance(const Vector3d& effort, const HandTarget& target, double duration_s) {
  const double steps = std::max(1.0, std::ceil(duration_s / parameters_.substep_s));
  const double dt = duration_s / steps;
  Vector3d own = effort;
  own.tail(3 - linkage_.axes()).setZero();
  HandTarget now = target;
  for (double i = 0.0; i < steps; i += 1.0) {
    now.position_m = target.position_m + (i + 1.0) * dt * target.velocity_m_s;
    substep(own, now, dt);
  }
}

double DevicePlant::kinetic_J() const {
  return 0.5 * inertia_.dot(joint_velocity_.cwiseAbs2()) +
         0.5 * tip_mass_ * tip_velocity_.squaredNorm();
}

double DevicePlant::potential_J() const {
  return parameters_.has_weight ? linkage_.potential_J(joints_) : 0.0;
}

/// Efforts of the links' weight at the joints: the negative gradient of the links' potential.
Vector3d DevicePlant::link_weight() const {
  constexpr double kStep = 1e-5;
  Vector3d slope = Vector3d::Zero();
  for (Eigen::Index i = 0; i < linkage_.axes(); ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    slope[i] =
        (linkage_.links_potential_J(joints_ + step) - linkage_.links_potential_J(joints_ - step)) /
        (2.0 * kStep);
  }
  return -slope;
}

void DevicePlant::substep(const Vector3d& effort, const HandTarget& target, double dt) {
  const HandParameters& hand = parameters_.hand;
  const Matrix3d& jacobian = pose_.jacobian;
  const Vector3d hand_N = hand.stiffness_N_m * (target.position_m - pose_.tip_m) +
                          hand.damping_Ns_m * (target.velocity_m_s - tip_velocity_);
  const double device_tip_kg = static_cast<double>(parameters_.model.tip_mass_kg);
  Vector3d joint_push = effort;
  Vector3d tip_push = hand_N;
  if (parameters_.has_weight) {
    joint_push += link_weight();
    tip_push.z() -= device_tip_kg * kGravity;
  }
  const bool massless = !(tip_mass_ > 0.0);
  joint_push += massless ? Vector3d(jacobian.transpose() * tip_push) : Vector3d::Zero();

  // Free motion under the efforts. The work of an impulse is its product with the mean of the
  // velocities before and after it.
  const Vector3d joint_free = joint_velocity_ + dt * joint_push.cwiseQuotient(inertia_);
  const Vector3d tip_free = massless ? tip_velocity_ : tip_velocity_ + dt / tip_mass_ * tip_push;
  const Vector3d joint_mean = 0.5 * (joint_velocity_ + joint_free);
  const Vector3d tip_mean =
      massless ? Vector3d(jacobian * joint_mean) : Vector3d(0.5 * (tip_velocity_ + tip_free));
  energy_.motor += dt * effort.dot(joint_mean);
  energy_.hand += dt * hand_N.dot(tip_mean);
  const double pushed =
      0.5 * inertia_.dot(joint_free.cwiseAbs2()) + 0.5 * tip_mass_ * tip_free.squaredNorm();

  Matrix3d mass = tip_mass_ * jacobian.transpose() * jacobian;
  mass.diagonal() += inertia_;
  const Vector3d momentum =
      inertia_.cwiseProduct(joint_free) + tip_mass_ * jacobian.transpose() * tip_free;
  // Implicit viscous friction is stable for every sub-step.
  mass.diagonal() += dt * viscous_;
  const Matrix3d inverse_mass = mass.inverse();
  joint_velocity_ = inverse_mass * momentum;
  rub(inverse_mass, dt);
  tip_velocity_ = jacobian * joint_velocity_;
  energy_.friction += pushed - kinetic_J();
  move(dt);
}

/// Dry friction reduces the speed of a joint and never reverses it; a stop ends the motion. The
/// impulses of the joints are found by projected Gauss-Seidel iteration.
void DevicePlant::rub(const Matrix3d& inverse_mass, double dt) {
  constexpr double kAll = std::numeric_limits<double>::max();
  const core::DeviceModel& model = parameters_.model;
  Vector3d impulse = Vector3d::Zero();
  for (int pass = 0; pass < kRubs; ++pass) {
    for (Eigen::Index i = 0; i < linkage_.axes(); ++i) {
      const double most = dt * coulomb_[i];
      const double low = joints_[i] >= static_cast<double>(model.joint_max[i]) ? -kAll : -most;
      const double high = joints_[i] <= static_cast<double>(model.joint_min[i]) ? kAll : most;
      const double wanted = impulse[i] - joint_velocity_[i] / inverse_mass(i, i);
      const double next = std::clamp(wanted, low, high);
      joint_velocity_ += (next - impulse[i]) * inverse_mass.col(i);
      if (next == wanted) {
        joint_velocity_[i] = 0.0;  // the joint stops: removes the rounding error
      }
      impulse[i] = next;
    }
  }
}

void DevicePlant::move(double dt) {
  const Vector3d joints = joints_ + dt * joint_velocity_;
  const std::optional<LinkagePose> pose = linkage_.pose(joints);
  if (!pose) {  // the linkage cannot close: the motion ends
    energy_.friction += kinetic_J();
    joint_velocity_.setZero();
    tip_velocity_.setZero();
    return;
  }
  joints_ = joints;
  pose_ = *pose;
}

}  // namespace tactree::plant
