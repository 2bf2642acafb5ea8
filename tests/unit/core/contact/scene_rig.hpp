#pragma once
// A scene and a probe that is led through it by hand, a tick a call.

#include "analytic_shapes.hpp"
#include "poses.hpp"
#include "tactree/core/contact/scene.hpp"

namespace tactree::test {

inline constexpr double kWall = 500.0;  // N/m
inline constexpr double kTick = 1e-3;   // s

inline core::Configuration smooth_wall() {
  core::Configuration configuration;
  configuration.contact.stiffness_N_m = static_cast<float>(kWall);
  configuration.contact.damping_Ns_m = 0.0F;
  configuration.contact.static_friction = 0.0F;
  configuration.contact.dynamic_friction = 0.0F;
  return configuration;
}

/// 4 cm wide, z = 0, outside is above.
inline const Shape& sheet() {
  static const Shape shape = plane(0.02);
  return shape;
}

class SceneRig {
 public:
  explicit SceneRig(const core::Configuration& c = smooth_wall()) : configuration(c) {}

  std::uint32_t add(const Shape& shape,
                    const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
    std::uint32_t number = core::kNoBody;
    status = scene.add(shape.view(), core::normalized(to_core(pose)), number);
    return number;
  }

  /// One tick; the measured velocity is the displacement of the probe over the period.
  const core::SceneRendering& tick(const Eigen::Vector3d& probe) {
    const Eigen::Vector3d velocity =
        started_ ? Eigen::Vector3d((probe - at_) / kTick) : Eigen::Vector3d::Zero();
    at_ = probe;
    started_ = true;
    return last = scene.update(configuration, narrow(probe), narrow(velocity));
  }

  /// Straight from where the probe is, at 0.1 m/s or `speed`.
  const core::SceneRendering& go(const Eigen::Vector3d& to, double speed = 0.1) {
    const Eigen::Vector3d from = started_ ? at_ : to;
    const int ticks = 1 + static_cast<int>((to - from).norm() / (speed * kTick));
    for (int i = 1; i <= ticks; ++i) {
      tick(from + (to - from) * (static_cast<double>(i) / ticks));
    }
    return last;
  }
  const core::SceneRendering& rest(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick(at_);
    }
    return last;
  }

  [[nodiscard]] Eigen::Vector3d force() const { return widen(last.contact.force); }
  [[nodiscard]] const Eigen::Vector3d& at() const { return at_; }

  core::Scene scene;
  core::Configuration configuration;
  core::ModelStatus status = core::ModelStatus::kOk;
  core::SceneRendering last;

 private:
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

}  // namespace tactree::test
