#include "tactree/simulation/body_path.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tactree/plant/vectors.hpp"

namespace tactree::simulation {
namespace {

using plant::narrow;

core::Pose to_pose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation) {
  const Eigen::Quaterniond q(rotation);
  return {{static_cast<float>(q.w()), narrow(q.vec())}, narrow(translation)};
}

core::Pose to_pose(const Eigen::Isometry3d& pose) {
  return to_pose(pose.linear(), pose.translation());
}

/// Rotation by the vector `by`: axis times angle, rad.
Eigen::Matrix3d turn(const Eigen::Vector3d& by) {
  const double angle = by.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, by / angle).toRotationMatrix()
                     : Eigen::Matrix3d::Identity();
}

}  // namespace

BodyPath::BodyPath(const Eigen::Isometry3d& pose) : BodyPath(std::vector<Keyframe>{{0.0, pose}}) {}

BodyPath::BodyPath(const Eigen::Isometry3d& pose, const Eigen::Vector3d& linear_m_s,
                   const Eigen::Vector3d& angular_rad_s)
    : keyframes_({{0.0, pose}}), linear_m_s_(linear_m_s), angular_rad_s_(angular_rad_s) {
  check();
}

BodyPath::BodyPath(std::vector<Keyframe> keyframes) : keyframes_(std::move(keyframes)) {
  if (keyframes_.empty()) {
    throw std::invalid_argument("there is no keyframe");
  }
  for (std::size_t i = 1; i < keyframes_.size(); ++i) {
    if (!(keyframes_[i].t_s > keyframes_[i - 1].t_s)) {
      throw std::invalid_argument("the times of the keyframes do not ascend");
    }
  }
  check();
}

void BodyPath::check() const {
  for (const Keyframe& keyframe : keyframes_) {
    const Moment moment = at(keyframe.t_s);
    if (!core::is_valid(to_pose(keyframe.pose))) {
      throw std::invalid_argument("a pose is not a rotation, or beyond +-10 m");
    }
    if (!core::is_valid(moment.motion)) {
      throw std::invalid_argument("a body moves faster than 10 m/s or turns faster than 100 rad/s");
    }
  }
}

BodyPath::Moment BodyPath::between(const Keyframe& from, const Keyframe& to, double t_s) const {
  const double duration = to.t_s - from.t_s;
  const double share = (t_s - from.t_s) / duration;
  const Eigen::AngleAxisd whole(Eigen::Matrix3d(to.pose.linear() * from.pose.linear().transpose()));
  const Eigen::Vector3d by = whole.angle() * whole.axis();
  const Eigen::Vector3d displacement = to.pose.translation() - from.pose.translation();
  Moment moment;
  moment.pose = to_pose(turn(share * by) * from.pose.linear(),
                        from.pose.translation() + share * displacement);
  moment.motion = {narrow(displacement / duration), narrow(by / duration)};
  return moment;
}

BodyPath::Moment BodyPath::at(double t_s) const {
  if (keyframes_.size() > 1) {
    const auto next =
        std::upper_bound(keyframes_.begin(), keyframes_.end(), t_s,
                         [](double t, const Keyframe& keyframe) { return t < keyframe.t_s; });
    if (next == keyframes_.begin() || next == keyframes_.end()) {
      return {to_pose(next == keyframes_.end() ? keyframes_.back().pose : next->pose), {}};
    }
    return between(*std::prev(next), *next, t_s);
  }
  const Eigen::Isometry3d& pose = keyframes_.front().pose;
  if (t_s < 0.0) {
    return {to_pose(pose), {}};
  }
  return {
      to_pose(turn(t_s * angular_rad_s_) * pose.linear(), pose.translation() + t_s * linear_m_s_),
      {narrow(linear_m_s_), narrow(angular_rad_s_)}};
}

}  // namespace tactree::simulation
