#pragma once
// The remaining work of a proxy in one tick. Every gather, pass and search is charged to it, which
// limits the duration of a tick.
//
// Interrupt safety: no shared state; one context owns a budget.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/contact/surface_work.hpp"

namespace tactree::core {

class TickBudget {
 public:
  /// Starts a tick with the limits of `work`, which must outlive it.
  void begin(const SurfaceWork& work) {
    limits_ = &work;
    gathers_ = work.gathers;  // memory: flash
    passes_ = work.passes;    // memory: flash
    all_ = work.all;          // memory: flash
    slice_ = work.slice;      // memory: flash
  }

  /// True if the budget allows a fit at a crease, or a fit of one face after a search for the
  /// nearest candidate.
  [[nodiscard]] bool allows_fit() const { return passes_ >= kPassesOfFit && all_ >= kPassesOfFit; }
  /// True if the budget allows a gather of at least one candidate.
  [[nodiscard]] bool allows_gather() const {
    return gathers_ != 0U && all_ >= kGatherWork && slice_.corners != 0U && slice_.points != 0U &&
           slice_.candidates != 0U;
  }

  /// Precondition: allows_gather(). Returns the slice that CandidateSet::gather() reduces.
  GatherSlice& spend_gather() {
    --gathers_;
    all_ -= kGatherWork;
    return slice_;
  }
  /// After a gather on demand that took no more than one ahead may: allows the fits that it cost.
  [[gnu::noinline]] void refund_small_gather() {
    const GatherSlice& whole = limits_->slice;
    const GatherSlice& small = limits_->ahead;
    const bool is_small =
        whole.corners - slice_.corners <= small.corners &&         // memory: flash
        whole.points - slice_.points <= small.points &&            // memory: flash
        whole.candidates - slice_.candidates <= small.candidates;  // memory: flash
    if (is_small) {
      all_ += kGatherWork;
    }
  }
  /// Takes the slice of a gather ahead. Returns false if a tick has gathered already, or gathers
  /// nothing ahead.
  [[nodiscard]] bool spend_ahead(GatherSlice& slice) {
    slice = limits_->ahead;  // memory: flash
    if (gathers_ == 0U || slice.corners == 0U) {
      return false;
    }
    --gathers_;
    return true;
  }
  /// Precondition: allows_fit(), checked once per fit including its search. Saturates at 0: an
  /// underflow would remove the limit.
  void spend_passes(std::uint32_t passes) {
    passes_ -= passes < passes_ ? passes : passes_;
    all_ -= passes < all_ ? passes : all_;
  }

 private:
  static constexpr std::uint32_t kPassesOfFit = 2;

  const SurfaceWork* limits_ = nullptr;
  // What is left of them.
  std::uint32_t gathers_ = 0;
  std::uint32_t passes_ = 0;
  std::uint32_t all_ = 0;
  GatherSlice slice_{};
};

}  // namespace tactree::core
