#pragma once
// Path of a rigid body: pose and velocities as a function of time.

#include <Eigen/Geometry>
#include <vector>

#include "tactree/core/math/pose.hpp"

namespace tactree::simulation {

struct Keyframe {
  double t_s = 0.0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< scene = pose * body
};

class BodyPath {
 public:
  struct Moment {
    core::Pose pose{};
    core::Motion motion{};
  };

  /// At rest at the identity pose.
  BodyPath() : BodyPath(Eigen::Isometry3d::Identity()) {}
  explicit BodyPath(const Eigen::Isometry3d& pose);

  /// At rest at `pose` until t = 0, then in motion with a constant linear velocity of the body's
  /// origin and a constant angular velocity, along and about the scene's axes. Throws
  /// std::invalid_argument if core::is_valid() refuses pose or motion.
  BodyPath(const Eigen::Isometry3d& pose, const Eigen::Vector3d& linear_m_s,
           const Eigen::Vector3d& angular_rad_s);

  /// Linear and angular velocity are constant between two keyframes; the body is at rest before the
  /// first and after the last. Throws std::invalid_argument if there is no keyframe, the times do
  /// not ascend, or core::is_valid() refuses a pose or motion.
  explicit BodyPath(std::vector<Keyframe> keyframes);

  [[nodiscard]] Moment at(double t_s) const;
  [[nodiscard]] const Eigen::Isometry3d& first() const { return keyframes_.front().pose; }

 private:
  void check() const;
  [[nodiscard]] Moment between(const Keyframe& from, const Keyframe& to, double t_s) const;

  std::vector<Keyframe> keyframes_;
  Eigen::Vector3d linear_m_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rad_s_ = Eigen::Vector3d::Zero();
};

}  // namespace tactree::simulation
