#pragma once
// From where the probe is to the force on the hand, before any limit.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/material.hpp"
#include "tactree/core/proxy.hpp"
#include "tactree/core/vec3.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kNoBody = 0xFFFFFFFFU;

/// What the rendering of one tick found. Model frame.
struct Rendering {
  bool in_contact = false;
  bool slipping = false;
  bool complete = true;          ///< false: the model breaks its own bounds; do not trust the force
  bool lost = false;             ///< the surface ended under the contact of the last tick
  Vec3 proxy{};                  ///< m; the probe when free
  Vec3 normal{};                 ///< outward; zero when free
  Vec3 force{};                  ///< N
  float stored_energy = 0.0F;    ///< J, in the spring between probe and proxy
  float strength = 0.0F;         ///< share of the force displayed; below 1 on a rim
  float penetration_m = 0.0F;    ///< from the probe to the proxy, along the normal; no texture
  std::uint32_t body = kNoBody;  ///< in a Scene: whose contact it is
};

/// Interrupt safe: no shared state. RAM: about 4 KiB, the proxy's scratch.
class Renderer {
 public:
  /// Forgets the contact. Call it when the model or the configuration changes.
  void reset(Vec3 probe) { proxy_.reset(probe); }

  /// Forgets a contact from the inner side of the surface.
  void let_out(Vec3 probe) {
    if (proxy_.from_behind()) {
      proxy_.reset(probe);
    }
  }

  /// One tick. `velocity` in m/s. Precondition: check(configuration) is kOk, probe is finite.
  /// Cost: surface mode: Proxy::update(); paper mode: paper_collision() and paper_nearest().
  Rendering update(const BlobView& view, const Configuration& configuration, Vec3 probe,
                   Vec3 velocity);

 private:
  /// What the hand feels of where the proxy is.
  [[gnu::noinline]] Rendering render_proxy(const BlobView& view, const Configuration& configuration,
                                           Vec3 probe, Vec3 velocity);

  Proxy proxy_;
  Friction friction_{};        // at the contact of the last tick
  MaterialBlend materials_{};  // of the contact, as of when candidates were whole last
};

}  // namespace tactree::core
