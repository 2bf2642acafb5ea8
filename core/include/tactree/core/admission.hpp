#pragma once
// Decides whether a controller takes a model: can the mode render it, is it stable, is a tick with
// it in time. Not part of a tick.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/scene.hpp"
#include "tactree/core/tick_cost.hpp"

namespace tactree::core {

class Admission {
 public:
  /// See Controller::know_costs().
  void know_costs(const TickCosts& costs, std::uint32_t cycles_per_second);

  /// kOk, kEmpty, kNoReach, kTooManyPoints, kTooStiff, or kTooSlow: for `view` beside the models of
  /// `others`. Cost: proportional to the materials of the model.
  [[nodiscard]] ModelStatus check(const BlobView& view, const TickLoad& others,
                                  const Configuration& configuration) const;

 private:
  [[nodiscard]] bool is_in_time(TickLoad load, const BlobView& added,
                                const Configuration& configuration) const;

  const TickCosts* costs_ = nullptr;
  std::uint32_t cycles_per_second_ = 0;
};

/// The models of a scene together.
[[nodiscard]] TickLoad load_of(const Scene& scene, const Configuration& configuration);

}  // namespace tactree::core
