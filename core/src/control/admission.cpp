// Loop and memory annotations: docs/BOUND.md.
#include "tactree/core/control/admission.hpp"

#include "tactree/core/contact/material.hpp"
#include "tactree/core/contact/surface.hpp"

namespace tactree::core {
namespace {

ModelStatus suitability(const BlobView& view, const Configuration& configuration) {
  const SurfaceSupport support = surface_support(view);
  if (support == SurfaceSupport::kEmpty) {
    return ModelStatus::kEmpty;
  }
  if (support != SurfaceSupport::kOk && configuration.mode != RenderMode::kPaper) {
    return support == SurfaceSupport::kNoReach ? ModelStatus::kNoReach
                                               : ModelStatus::kTooManyPoints;
  }
  const bool stable = find_unstable_material(view, configuration) == kNoMaterial;
  return stable ? ModelStatus::kOk : ModelStatus::kTooStiff;
}

}  // namespace

void Admission::know_costs(const TickCosts& costs, std::uint32_t cycles_per_second) {
  costs_ = &costs;
  cycles_per_second_ = cycles_per_second;
}

ModelStatus Admission::check(const BlobView& view, const TickLoad& others,
                             const Configuration& configuration) const {
  const ModelStatus status = suitability(view, configuration);
  if (status != ModelStatus::kOk) {
    return status;
  }
  TickLoad all = others;
  all.add(view.header(), configuration);
  return work_tier(all, configuration) < kWorkTiers ? ModelStatus::kOk : ModelStatus::kTooSlow;
}

std::uint32_t Admission::work_tier(const TickLoad& load, const Configuration& configuration) const {
  if (costs_ == nullptr || costs_->known != kTickCostsKnown) {
    return work_tier_of(configuration.rate_hz);
  }
  const float period = static_cast<float>(cycles_per_second_) / configuration.rate_hz;
  return work_tier_in_time(*costs_, load, static_cast<std::uint32_t>(period));
}

TickLoad load_of(const Scene& scene, const Configuration& configuration) {
  TickLoad load;
  for (std::uint32_t i = 0; i < kMaxBodies; ++i) {  // bound: kMaxBodies
    if (!scene.view(i).empty()) {
      load.add(scene.view(i).header(), configuration);
    }
  }
  return load;
}

}  // namespace tactree::core
