#pragma once
// A probe that touches bodies at rest in one mode, with one update of the scene per tick.

#include <Eigen/Core>
#include <span>
#include <stdexcept>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
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

/// Throws std::logic_error if the scene refuses the body.
inline void add_at_rest(core::Scene& scene, const core::BlobView& body) {
  std::uint32_t number = 0;
  const core::ModelStatus status = scene.add(body, {}, number);
  if (status != core::ModelStatus::kOk) {
    throw std::logic_error(core::describe(status));
  }
}

class Touch {
 public:
  /// Starts at `probe`. The blobs must outlive the object.
  Touch(std::span<const core::BlobView> bodies, core::RenderMode mode, const Eigen::Vector3d& probe,
        const core::Friction& friction = {}, double rate_hz = 1.0 / kPeriodS) {
    configuration_.rate_hz = static_cast<float>(rate_hz);
    configuration_.mode = mode;
    configuration_.contact.stiffness_N_m = static_cast<float>(kStiffness_N_m);
    configuration_.contact.damping_Ns_m = 0.0F;
    configuration_.contact.static_friction = friction.static_coefficient;
    configuration_.contact.dynamic_friction = friction.dynamic_coefficient;
    for (const core::BlobView& body : bodies) {
      add_at_rest(scene_, body);
    }
    scene_.reset(narrow(probe));
  }
  Touch(const core::BlobView& body, core::RenderMode mode, const Eigen::Vector3d& probe,
        const core::Friction& friction = {}, double rate_hz = 1.0 / kPeriodS)
      : Touch(std::span(&body, 1), mode, probe, friction, rate_hz) {}

  Touched to(const Eigen::Vector3d& probe) {
    const core::SceneRendering& scene = scene_.update(configuration_, narrow(probe), {});
    const core::Rendering& r = scene.contact;
    return {r.in_contact, r.slipping, scene.inside, widen(r.force), widen(r.proxy)};
  }

 private:
  core::Configuration configuration_{};
  core::Scene scene_{};
};

}  // namespace tactree::evaluation
