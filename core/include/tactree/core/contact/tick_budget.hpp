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
  /// Starts a tick with the limits of `work`.
  void begin(const SurfaceWork& work) {
    left_ = work;  // memory: flash
  }

  /// True if the budget allows a fit at a crease, or a fit of one face after a search for the
  /// nearest candidate.
  [[nodiscard]] bool allows_fit() const {
    return left_.passes >= kPassesOfFit && left_.all >= kPassesOfFit;
  }
  /// True if the budget allows a gather of at least one candidate.
  [[nodiscard]] bool allows_gather() const {
    const GatherSlice& slice = left_.slice;
    return left_.gathers != 0U && left_.all >= kGatherWork && slice.corners != 0U &&
           slice.points != 0U && slice.candidates != 0U;
  }

  /// Precondition: allows_gather(). Returns the slice that CandidateSet::gather() reduces.
  GatherSlice& spend_gather() {
    --left_.gathers;
    left_.all -= kGatherWork;
    return left_.slice;
  }
  /// Precondition: allows_fit(), checked once per fit including its search. Saturates at 0: an
  /// underflow would remove the limit.
  void spend_passes(std::uint32_t passes) {
    left_.passes -= passes < left_.passes ? passes : left_.passes;
    left_.all -= passes < left_.all ? passes : left_.all;
  }

 private:
  static constexpr std::uint32_t kPassesOfFit = 2;

  SurfaceWork left_{};
};

}  // namespace tactree::core
