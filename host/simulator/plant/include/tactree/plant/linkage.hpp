#pragma once
// Kinematics of a simulated device in double precision. They are independent of the controller's
// kinematics and based on other equations, so that each verifies the other.

#include <Eigen/Core>
#include <optional>

#include "tactree/core/device/device_model.hpp"

namespace tactree::plant {

inline constexpr double kGravity = 9.80665;  // m/s2

/// Position of the tip in the device frame, and its Jacobian. Each column is the motion of the tip
/// per motion of one joint; the column of an unused joint is zero.
struct LinkagePose {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
};

class Linkage {
 public:
  /// Precondition: core::is_valid(model).
  explicit Linkage(const core::DeviceModel& model) : model_(model) {}

  /// Empty if the loops of the linkage cannot close at these joints.
  [[nodiscard]] std::optional<LinkagePose> pose(const Eigen::Vector3d& joints) const;

  /// Joint positions within their ranges that bring the tip nearest to a position. Damped least
  /// squares from the centre of the ranges, at most 200 steps.
  [[nodiscard]] Eigen::Vector3d joints_near(const Eigen::Vector3d& tip_m) const;

  /// Potential energy of links and tip, J; its gradient is the effort of gravity compensation.
  [[nodiscard]] double potential_J(const Eigen::Vector3d& joints) const;

  /// Potential energy of the links only, J.
  [[nodiscard]] double links_potential_J(const Eigen::Vector3d& joints) const;

  [[nodiscard]] const core::DeviceModel& model() const { return model_; }
  [[nodiscard]] Eigen::Index axes() const {
    return static_cast<Eigen::Index>(core::axes_of(model_.kind));
  }

 private:
  core::DeviceModel model_;
};

}  // namespace tactree::plant
