#pragma once
// The contact force of one model at the probe, before any limit.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/material.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/math/vec3.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

inline constexpr std::uint32_t kNoBody = 0xFFFFFFFFU;

/// The contact of one tick. Model frame; a Scene converts it to the scene's frame.
struct Rendering {
  bool in_contact = false;  ///< also while the proxy falls from one face to another
  bool slipping = false;
  bool complete = true;          ///< false: the model holds more points than it declares
  bool inside = false;           ///< in the material, without force until the probe has left it
  Vec3 proxy{};                  ///< m; the probe when free. Above the surface while it falls
  Vec3 normal{};                 ///< outward; zero when free
  Vec3 force{};                  ///< N
  float stored_energy = 0.0F;    ///< J, in the spring between probe and proxy
  float strength = 0.0F;         ///< scale factor of the force; below 1 at a boundary
  float penetration_m = 0.0F;    ///< of the probe, along the normal, without the texture
  std::uint32_t body = kNoBody;  ///< in a Scene: number of the body in contact
};

/// Interrupt safety: no shared state; one context owns a renderer. RAM: about 8 KiB, mostly the
/// proxy's candidates.
class Renderer {
 public:
  /// Clears the contact. Required whenever the model or the configuration changes.
  void reset(Vec3 probe) { proxy_.reset(probe); }

  /// Clears a contact with the back of a sheet; keeps any other contact.
  void release_back(Vec3 probe) {
    if (proxy_.from_behind()) {
      proxy_.reset(probe);
    }
  }

  // One tick; `probe` in m, `velocity` in m/s. Preconditions: check(configuration) is kOk, `probe`
  // is finite.

  /// Surface mode: track() moves the proxy, render_proxy() computes the force. The work is that of
  /// the tier of the rate, or of `least_tier` if that is later. With a neighbour, render only the
  /// proxy that leads: see proxy.hpp. Cost: Proxy::update().
  void track(const BlobView& view, const Configuration& configuration, Vec3 probe,
             std::uint32_t least_tier, const Neighbour* neighbour) {
    proxy_.update(view, probe, friction_, work_per_tick(configuration.rate_hz, least_tier),
                  neighbour);
  }
  [[gnu::noinline]] Rendering render_proxy(const BlobView& view, const Configuration& configuration,
                                           Vec3 probe, Vec3 velocity);
  /// Paper mode. Cost: paper_collision() and paper_nearest().
  [[nodiscard]] static Rendering render_paper(const BlobView& view,
                                              const Configuration& configuration, Vec3 probe);

  [[nodiscard]] Proxy& proxy() { return proxy_; }
  [[nodiscard]] const Proxy& proxy() const { return proxy_; }

 private:
  Friction friction_{};        // of the contact in the last tick
  MaterialBlend materials_{};  // of the contact, blended when its candidates were last valid
  Proxy proxy_;
};

}  // namespace tactree::core
