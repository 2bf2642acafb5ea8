#pragma once
// Decides whether a controller takes a model: can the mode render it, is it stable, is a tick with
// it in time. Not part of a tick.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/control/tick_cost.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

class Admission {
 public:
  /// See Controller::know_costs().
  void know_costs(const TickCosts& costs, std::uint32_t cycles_per_second);

  /// kOk, kEmpty, kNoReach, kTooManyPoints, kTooStiff, or kTooSlow: for `view` beside the models of
  /// `others`. Cost: proportional to the materials of the model.
  [[nodiscard]] ModelStatus check(const BlobView& view, const TickLoad& others,
                                  const Configuration& configuration) const;

  /// Tier of the most work that a tick does in time for these models: that of the rate, or a later
  /// one on a slow board. kWorkTiers: a tick with the least work is too long. Unknown costs: that
  /// of the rate.
  [[nodiscard]] std::uint32_t work_tier(const TickLoad& load,
                                        const Configuration& configuration) const;

 private:
  const TickCosts* costs_ = nullptr;
  std::uint32_t cycles_per_second_ = 0;
};

/// The models of a scene together.
[[nodiscard]] TickLoad load_of(const Scene& scene, const Configuration& configuration);

}  // namespace tactree::core
