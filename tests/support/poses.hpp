#pragma once
// Poses in double precision beside those of the core.

#include <Eigen/Geometry>
#include <random>

#include "analytic_shapes.hpp"
#include "tactree/core/math/pose.hpp"

namespace tactree::test {

inline Eigen::Isometry3d isometry(const Eigen::Vector3d& translation_m,
                                  const Eigen::Vector3d& turn_rad = Eigen::Vector3d::Zero()) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(translation_m);
  if (turn_rad.norm() > 0.0) {
    pose.rotate(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()));
  }
  return pose;
}

/// Where nothing at the origin is touched.
inline const Eigen::Isometry3d kFar = isometry({0.0, 0.0, -1.0});

inline core::Pose to_core(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {{static_cast<float>(q.w()), narrow(q.vec())}, narrow(pose.translation())};
}

inline Eigen::Isometry3d to_eigen(const core::Pose& pose) {
  const core::Quaternion& q = pose.rotation;
  const Eigen::Vector3d v = widen(q.v);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translate(widen(pose.translation_m));
  result.rotate(Eigen::Quaterniond(static_cast<double>(q.w), v.x(), v.y(), v.z()).normalized());
  return result;
}

class RandomPoses {
 public:
  explicit RandomPoses(unsigned seed) : random_(seed) {}
  Eigen::Vector3d vector(double size) {
    std::uniform_real_distribution<double> component(-size, size);
    const double x = component(random_);
    const double y = component(random_);
    return {x, y, component(random_)};
  }
  Eigen::Isometry3d pose(double translation_m) {
    const Eigen::Vector3d translation = vector(translation_m);
    return isometry(translation, vector(3.0));
  }

 private:
  std::mt19937 random_;
};

}  // namespace tactree::test
