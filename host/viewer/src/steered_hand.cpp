#include "steered_hand.hpp"

#include <algorithm>
#include <utility>

namespace tactree::viewer {
namespace {

// Time constant with which the hand slows down before a sharp corner or the end.
constexpr double kFollow_s = 0.03;
// Minimum speed before a corner, at which the hand's spring overshoots less than a millimetre.
// There is no minimum speed before the end.
constexpr double kAtCorner_m_s = 0.05;
// A corner is sharp if the path turns by more than 60 degrees.
constexpr double kSharpCosine = 0.5;

}  // namespace

void SteeredHand::go(std::vector<Eigen::Vector3d> path_m, double speed_m_s) {
  path_m_ = std::move(path_m);
  speed_m_s_ = speed_m_s;
  next_ = 0;
}

double SteeredHand::distance_to_slow_point() const {
  Eigen::Vector3d part = path_m_[next_] - now_.position_m;
  double distance = part.norm();
  for (std::size_t i = next_; i + 1 < path_m_.size(); ++i) {
    const Eigen::Vector3d following = path_m_[i + 1] - path_m_[i];
    if (part.dot(following) < kSharpCosine * part.norm() * following.norm()) {
      break;
    }
    distance += following.norm();
    part = following;
  }
  return distance;
}

const plant::HandTarget& SteeredHand::advance(double dt) {
  const bool is_last = next_ + 1 == path_m_.size();
  const Eigen::Vector3d offset = path_m_[next_] - now_.position_m;
  const double slowest = is_last ? 0.0 : std::min(kAtCorner_m_s, speed_m_s_);
  const double speed = std::clamp(distance_to_slow_point() / kFollow_s, slowest, speed_m_s_);
  const double remaining = offset.norm();
  if (!is_last && remaining <= speed * dt) {
    now_.velocity_m_s = offset / dt;
    now_.position_m = path_m_[next_++];
    return now_;
  }
  now_.velocity_m_s = remaining > 0.0 ? Eigen::Vector3d(offset * (speed / remaining))
                                      : Eigen::Vector3d(Eigen::Vector3d::Zero());
  now_.position_m += dt * now_.velocity_m_s;
  return now_;
}

}  // namespace tactree::viewer
