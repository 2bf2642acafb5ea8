#pragma once
// The kinematics of a simulated device in double precision, written apart from those of the
// controller and from other equations, so that one tests the other.

#include <Eigen/Core>
#include <optional>

#include "tactree/core/device_model.hpp"

namespace tactree::plant {

/// Where the tip is, device frame. Columns of `jacobian`: motion of the tip per motion of each
/// joint; zero of an unused one.
struct LinkagePose {
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
};

class Linkage {
 public:
  /// Precondition: core::is_valid(model).
  explicit Linkage(const core::DeviceModel& model) : model_(model) {}

  /// Empty where the joints do not fit together.
  [[nodiscard]] std::optional<LinkagePose> pose(const Eigen::Vector3d& joints) const;

  /// Joints, within their ranges, that bring the tip as near as they can to a place: damped least
  /// squares from the middle of the ranges, at most 200 steps.
  [[nodiscard]] Eigen::Vector3d joints_near(const Eigen::Vector3d& tip_m) const;

  /// Potential energy of links and tip, J; its gradient is what gravity compensation must hold.
  [[nodiscard]] double potential_J(const Eigen::Vector3d& joints) const;

  /// The same without the tip's mass.
  [[nodiscard]] double links_potential_J(const Eigen::Vector3d& joints) const;

  [[nodiscard]] const core::DeviceModel& model() const { return model_; }
  [[nodiscard]] Eigen::Index axes() const {
    return static_cast<Eigen::Index>(core::axes_of(model_.kind));
  }

 private:
  core::DeviceModel model_;
};

}  // namespace tactree::plant
