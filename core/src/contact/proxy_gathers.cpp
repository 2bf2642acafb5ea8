// The candidates of a proxy: gathered on demand for a fit, and ahead of its motion.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/proxy.hpp"

namespace tactree::core {
namespace {

constexpr bool fits_once_with_both_sets() {
  for (const SurfaceWork& work : kWorkPerTick) {  // bound: kWorkTiers
    if (work.gathers_ahead() && work.passes > 2U) {
      return false;
    }
  }
  return true;
}

}  // namespace

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

// A second set is taken before the only fit of a tick: the neighbour has not hidden points yet.
static_assert(fits_once_with_both_sets());
/// True if a set covers `x`; that set is then in use.
[[gnu::noinline]] bool Proxy::covers(Vec3 x) {
  if (candidates_.in_use().covers(x)) {
    return true;
  }
  // at most: ahead * max(1, 2 * fits_of_one - 1) per Proxy::update
  return candidates_.uses_both() && candidates_.take_other(x);
}

// Provides candidates for a fit at x. Returns false if no fit is possible in this tick; has_next_
// is then true if the fit at x has to wait for its candidates.
bool Proxy::prepare_fit(const BlobView& view, Vec3 x) {
  if (!budget_.allows_fit()) {
    return false;
  }
  // at most: max(1, 2 * fits_of_one - 1) per Proxy::update
  if (!covers(x)) {
    if (!budget_.allows_gather()) {
      return false;
    }
    has_next_ = !gather(view, x) || !budget_.allows_fit();
    next_ = x;
    if (has_next_ || !candidates_.in_use().covers(x)) {
      return false;
    }
  }
  if (must_hide_) {
    // at most: min(bodies, 2) / 2 * fits per Scene::update
    hide_points(view.support_radius_m());
  }
  return true;
}

/// Gathers with what the fits have left, ahead of a proxy that was at `begin` before this tick.
[[gnu::noinline]] void Proxy::gather_ahead(const BlobView& view, Vec3 begin) {
  GatherSlice slice;
  if (!budget_.spend_ahead(slice)) {
    return;
  }
  // at most: gathers per Scene::update together begins
  if (candidates_.begin_ahead(view, position_, position_ - begin)) {
    // at most: gathers per Scene::update together gathers
    (void)candidates_.continue_gather(view, slice);
  }
}

}  // namespace tactree::core
