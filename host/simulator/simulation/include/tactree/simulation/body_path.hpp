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

  /// At rest.
  BodyPath() : BodyPath(Eigen::Isometry3d::Identity()) {}
  explicit BodyPath(const Eigen::Isometry3d& pose);

  /// Starts at `pose` at t = 0 with constant velocities of the body's origin, scene axes; at rest
  /// before. Throws std::invalid_argument if core::is_valid() refuses pose or motion.
  BodyPath(const Eigen::Isometry3d& pose, const Eigen::Vector3d& linear_m_s,
           const Eigen::Vector3d& angular_rad_s);

  /// Constant linear and angular velocity between two keyframes; at rest before the first and after
  /// the last. Throws std::invalid_argument if there is no keyframe, the times do not ascend, or
  /// core::is_valid() refuses a pose or motion.
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
