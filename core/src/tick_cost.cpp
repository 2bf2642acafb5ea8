#include "tactree/core/tick_cost.hpp"

#include "tactree/core/material.hpp"

namespace tactree::core {
namespace {

constexpr std::uint32_t TickFigures::*kFigures[] = {&TickFigures::points_per_ball_max,
                                                    &TickFigures::points_per_query_max,
                                                    &TickFigures::points_per_slab_max,
                                                    &TickFigures::points_per_leaf_max,
                                                    &TickFigures::depth,
                                                    &TickFigures::levels_below,
                                                    &TickFigures::blended_points,
                                                    &TickFigures::blended_materials,
                                                    &TickFigures::delta};
static_assert(sizeof(kFigures) / sizeof(kFigures[0]) == kTickFigures);

constexpr std::uint32_t smaller_of(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

}  // namespace

TickFigures tick_figures(const BlobHeader& h, DeviceKind device) {
  TickFigures figures;
  figures.points_per_ball_max = h.points_per_ball_max;
  figures.points_per_query_max = h.points_per_query_max;
  figures.points_per_slab_max = h.points_per_slab_max;
  figures.points_per_leaf_max = h.points_per_leaf_max;
  figures.depth = h.depth;
  figures.levels_below = h.depth - h.directory_level;
  figures.blended_points = h.material_count > 1U ? h.points_per_ball_max : 0U;
  figures.blended_materials = smaller_of(h.material_count, kBlendedMaterials);
  figures.delta = device == DeviceKind::kDelta ? 1U : 0U;
  return figures;
}

void TickLoad::add(const BlobHeader& header, const Configuration& configuration) {
  const TickFigures added = tick_figures(header, configuration.device.kind);
  for (const auto figure : kFigures) {  // bound: kTickFigures
    figures.*figure = added.*figure < figures.*figure ? figures.*figure : added.*figure;
  }
  const TickKind its_kind = tick_kind(header, configuration.mode);
  pace = pace_of(configuration.rate_hz);
  kind = its_kind == TickKind::kSurface ? kind : its_kind;
  ++bodies;
}

std::uint64_t cycles_of(const TickCost& cost, const TickFigures& figures) {
  std::uint64_t cycles = cost.base;
  for (std::uint32_t i = 0; i < kTickFigures; ++i) {  // bound: kTickFigures
    cycles += static_cast<std::uint64_t>(cost.per_figure[i]) * (figures.*kFigures[i]);
  }
  return cycles;
}

std::uint64_t cycles_of(const TickCosts& costs, const TickLoad& load) {
  const std::uint32_t row = smaller_of(load.bodies, kMaxReachableBodies) - 1U;
  return cycles_of(costs.of[static_cast<std::uint32_t>(load.kind)][load.pace][row], load.figures);
}

TickKind tick_kind(const BlobHeader& header, RenderMode mode) {
  if (mode == RenderMode::kPaper) {
    return TickKind::kPaper;
  }
  const bool is_mixed = header.profile == static_cast<std::uint32_t>(Profile::kPaper);
  return is_mixed ? TickKind::kMixed : TickKind::kSurface;
}

}  // namespace tactree::core
