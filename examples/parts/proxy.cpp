// The force of a surface with friction, for a controller of your own. Call force_at() once per
// tick.
#include "tactree/core/contact/proxy.hpp"

using namespace tactree::core;

constexpr float kRate_hz = 1000.0F, kStiffness_N_m = 500.0F;
constexpr Friction kFriction = {.static_coefficient = 0.4F, .dynamic_coefficient = 0.3F};
static Proxy proxy;  // reset() it at the probe whenever the model changes

Vec3 force_at(const BlobView& model, Vec3 probe) {
  proxy.update(model, probe, kFriction, work_per_tick(kRate_hz));
  const Vec3 stretched = proxy.position() - probe;
  return proxy.in_contact() ? kStiffness_N_m * proxy.strength() * stretched : Vec3{};
}
