// The gathers of a proxy: on demand for a fit that waits, and ahead of its motion.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/proxy.hpp"

namespace tactree::core {

/// Gathers candidates for a fit at `x`. Returns true if the gather has ended.
[[gnu::noinline]] bool Proxy::gather(const BlobView& view, Vec3 x) {
  GatherSlice& slice = budget_.spend_gather();
  candidates_.begin_on_demand(view, x);  // at most: gathers per Scene::update together begins
  must_hide_ = neighbour_ != nullptr;
  // at most: gathers per Scene::update together gathers
  const bool has_ended = candidates_.continue_gather(view, slice);
  if (candidates_.uses_both()) {
    budget_.refund_small_gather();  // at most: ahead per Proxy::update
  }
  return has_ended;
}

/// Gathers with what the fits have left, ahead of a proxy that was at `begin` before this tick.
[[gnu::noinline]] void Proxy::gather_ahead(const BlobView& view, Vec3 probe, Vec3 begin) {
  GatherSlice slice;
  if (!budget_.spend_ahead(slice)) {
    return;
  }
  // A free proxy that has not caught up with the probe goes on by a step.
  const Vec3 path = (is_led() ? neighbour_->proxy : probe) - position_;
  const float step = 0.5F * view.support_radius_m();
  const float distance = length(path);
  const bool is_late = !in_contact() && distance > step;
  const Vec3 travel = is_late ? (step / distance) * path : position_ - begin;
  // at most: gathers per Scene::update together begins
  if (candidates_.begin_ahead(view, position_, travel)) {
    // at most: gathers per Scene::update together gathers
    (void)candidates_.continue_gather(view, slice);
  }
}

}  // namespace tactree::core
