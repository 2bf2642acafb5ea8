#pragma once
// The way of a rigid body: where it is at each time, and how it moves there.

#include <Eigen/Geometry>
#include <vector>

#include "tactree/core/pose.hpp"

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

  /// From `pose` at t = 0 on with constant velocities of the body's origin, scene's axes; before
  /// that at rest. Throws std::invalid_argument where core::is_valid() refuses pose or motion.
  BodyPath(const Eigen::Isometry3d& pose, const Eigen::Vector3d& linear_m_s,
           const Eigen::Vector3d& angular_rad_s);

  /// Straight and evenly turning from one keyframe to the next; before the first and after the last
  /// at rest. Throws std::invalid_argument unless there is one, time ascends, and core::is_valid()
  /// accepts poses and motions.
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
