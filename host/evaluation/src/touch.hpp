#pragma once
// A probe that touches a blob in one mode, with one update of the renderer per tick.

#include <Eigen/Core>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/renderer.hpp"
#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

inline constexpr double kStiffness_N_m = 1000.0;
inline constexpr double kPeriodS = 1e-3;

struct Touched {
  bool in_contact = false;
  bool slipping = false;
  bool inside = false;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
  Eigen::Vector3d proxy = Eigen::Vector3d::Zero();  // m
};

class Touch {
 public:
  /// Starts in free space at `probe`. `view` must outlive the object.
  Touch(const core::BlobView& view, core::RenderMode mode, const Eigen::Vector3d& probe,
        const core::Friction& friction = {}, double rate_hz = 1.0 / kPeriodS)
      : view_(view) {
    configuration_.rate_hz = static_cast<float>(rate_hz);
    configuration_.mode = mode;
    configuration_.contact.stiffness_N_m = static_cast<float>(kStiffness_N_m);
    configuration_.contact.damping_Ns_m = 0.0F;
    configuration_.contact.static_friction = friction.static_coefficient;
    configuration_.contact.dynamic_friction = friction.dynamic_coefficient;
    renderer_.reset(narrow(probe));
  }

  Touched to(const Eigen::Vector3d& probe) {
    const core::Rendering r = renderer_.update(view_, configuration_, narrow(probe), {});
    return {r.in_contact, r.slipping, r.inside, widen(r.force), widen(r.proxy)};
  }

 private:
  const core::BlobView& view_;
  core::Configuration configuration_{};
  core::Renderer renderer_{};
};

}  // namespace tactree::evaluation
