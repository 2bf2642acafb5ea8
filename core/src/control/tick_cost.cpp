// Loop and memory annotations: docs/BOUND.md.

#include "tactree/core/control/tick_cost.hpp"

#include "tactree/core/contact/material.hpp"

namespace tactree::core {
namespace {

constexpr std::uint32_t ModelLimits::*kLimitMembers[] = {
    &ModelLimits::points_per_ball_max, &ModelLimits::points_per_support_max,
    &ModelLimits::points_per_leaf_max, &ModelLimits::depth,
    &ModelLimits::levels_below,        &ModelLimits::blended_points,
    &ModelLimits::blended_materials};
static_assert(sizeof(kLimitMembers) / sizeof(kLimitMembers[0]) == kModelLimits);

constexpr std::uint32_t smaller_of(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

}  // namespace

ModelLimits model_limits(const BlobHeader& h) {
  ModelLimits limits;
  limits.points_per_ball_max = h.points_per_ball_max;
  limits.points_per_support_max = points_per_support_max(h);
  limits.points_per_leaf_max = h.points_per_leaf_max;
  limits.depth = h.depth;
  limits.levels_below = h.depth - h.directory_level;
  limits.blended_points = h.material_count > 1U ? h.points_per_ball_max : 0U;
  limits.blended_materials = smaller_of(h.material_count, kBlendedMaterials);
  return limits;
}

void TickLoad::add(const BlobHeader& header, const Configuration& configuration) {
  const ModelLimits added = model_limits(header);
  for (const auto limit : kLimitMembers) {  // bound: kModelLimits
    limits.*limit = added.*limit < limits.*limit ? limits.*limit : added.*limit;
  }
  const TickKind its_kind = tick_kind(header, configuration.mode);
  kind = its_kind == TickKind::kSurface ? kind : its_kind;
  work_tier = work_tier_of(configuration.rate_hz);
  delta = configuration.device.kind == DeviceKind::kDelta;
  ++bodies;
}

std::uint64_t cycles_of(const TickCost& cost, const ModelLimits& limits) {
  std::uint64_t cycles = cost.base;
  for (std::uint32_t i = 0; i < kModelLimits; ++i) {  // bound: kModelLimits
    const std::uint32_t limit = limits.*kLimitMembers[i];
    const std::uint32_t least = kLeastLimits.*kLimitMembers[i];
    if (limit > least) {
      cycles += static_cast<std::uint64_t>(cost.per_limit[i]) * (limit - least);
    }
  }
  return cycles;
}

const TickCost& worst_row(const TickCosts& costs, const TickLoad& load) {
  if (load.kind == TickKind::kPaper) {
    return costs.paper;
  }
  const std::uint32_t bodies = smaller_of(load.bodies, kMaxReachableBodies);
  const TickCost* const rows =
      costs.surface[static_cast<std::uint32_t>(load.kind)] + first_row(load.work_tier, bodies);
  const TickCost* worst = rows;
  for (std::uint32_t i = 1; i < rows_of(load.work_tier, bodies); ++i) {  // bound: kTickRows
    if (cycles_of(rows[i], load.limits) > cycles_of(*worst, load.limits)) {
      worst = rows + i;
    }
  }
  return *worst;
}

std::uint64_t cycles_of(const TickCosts& costs, const TickLoad& load) {
  const std::uint64_t each = cycles_of(worst_row(costs, load), load.limits);
  return costs.base + (load.delta ? costs.delta : 0U) +
         static_cast<std::uint64_t>(costs.listed) * load.bodies +
         each * smaller_of(load.bodies, kMaxReachableBodies);
}

std::uint32_t work_tier_in_time(const TickCosts& costs, TickLoad load, std::uint64_t cycles) {
  while (load.work_tier < kWorkTiers && cycles_of(costs, load) > cycles) {  // bound: kWorkTiers
    ++load.work_tier;
  }
  return load.work_tier;
}

TickKind tick_kind(const BlobHeader& header, RenderMode mode) {
  if (mode == RenderMode::kPaper) {
    return TickKind::kPaper;
  }
  const bool is_mixed = header.profile == static_cast<std::uint32_t>(Profile::kPaper);
  return is_mixed ? TickKind::kMixed : TickKind::kSurface;
}

}  // namespace tactree::core
