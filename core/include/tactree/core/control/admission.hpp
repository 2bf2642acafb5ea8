#pragma once
// Decides whether a controller accepts a model: the mode must be able to render it, its materials
// must be stable, and a tick with it must end in time. Not part of a tick.

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

  /// Checks `view` in addition to the models of `others`. Returns kOk, kEmpty, kNoReach,
  /// kTooManyPoints, kTooStiff or kTooSlow. Cost: proportional to the number of materials.
  [[nodiscard]] ModelStatus check(const BlobView& view, const TickLoad& others,
                                  const Configuration& configuration) const;

  /// First tier at which a tick with these models ends in time: the tier of the rate, or a later
  /// one on a slow board. Returns kWorkTiers if no tier suffices, and the tier of the rate if the
  /// costs are unknown.
  [[nodiscard]] std::uint32_t work_tier(const TickLoad& load,
                                        const Configuration& configuration) const;

 private:
  const TickCosts* costs_ = nullptr;
  std::uint32_t cycles_per_second_ = 0;
};

/// The load of all models of a scene.
[[nodiscard]] TickLoad load_of(const Scene& scene, const Configuration& configuration);

}  // namespace tactree::core
