#pragma once
// The work that remains to a proxy in one tick. Every gather, pass and search is spent here, which
// limits the length of a tick.
//
// Interrupt safety: no shared state; one context owns a budget.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include <cstdint>

#include "tactree/core/surface_work.hpp"

namespace tactree::core {

class TickBudget {
 public:
  /// Starts a tick with the limits of `work` and one search per gather.
  void begin(const SurfaceWork& work) {
    left_ = work;                   // memory: flash
    searches_left_ = work.gathers;  // memory: flash
  }

  /// Room for a fit, including the second pass that a crease takes.
  [[nodiscard]] bool allows_fit() const {
    return left_.passes >= kPassesOfFit && left_.all >= kPassesOfFit;
  }
  /// Room for a search for the nearest candidate.
  [[nodiscard]] bool allows_search() const { return searches_left_ != 0U; }
  /// Room for a gather of at least one candidate.
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
  /// Precondition: allows_fit(), once per fit.
  void spend_passes(std::uint32_t passes) {
    left_.passes -= passes;
    left_.all -= passes;
  }
  /// Precondition: allows_search().
  void spend_search() { --searches_left_; }

 private:
  static constexpr std::uint32_t kPassesOfFit = 2;

  SurfaceWork left_{};
  std::uint32_t searches_left_ = 0;
};

}  // namespace tactree::core
