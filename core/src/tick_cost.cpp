#include "tactree/core/tick_cost.hpp"

#include "tactree/core/material.hpp"

namespace tactree::core {
namespace {

constexpr std::uint32_t TickFigures::*kFigures[] = {&TickFigures::points_per_ball_max,
                                                    &TickFigures::points_per_leaf_max,
                                                    &TickFigures::depth,
                                                    &TickFigures::levels_below,
                                                    &TickFigures::blended_points,
                                                    &TickFigures::blended_materials};
static_assert(sizeof(kFigures) / sizeof(kFigures[0]) == kTickFigures);

constexpr std::uint32_t smaller_of(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }

}  // namespace

TickFigures tick_figures(const BlobHeader& h) {
  TickFigures figures;
  figures.points_per_ball_max = h.points_per_ball_max;
  figures.points_per_leaf_max = h.points_per_leaf_max;
  figures.depth = h.depth;
  figures.levels_below = h.depth - h.directory_level;
  figures.blended_points = h.material_count > 1U ? h.points_per_ball_max : 0U;
  figures.blended_materials = smaller_of(h.material_count, kBlendedMaterials);
  return figures;
}

void TickLoad::add(const BlobHeader& header, const Configuration& configuration) {
  const TickFigures added = tick_figures(header);
  for (const auto figure : kFigures) {  // bound: kTickFigures
    figures.*figure = added.*figure < figures.*figure ? figures.*figure : added.*figure;
  }
  const TickKind its_kind = tick_kind(header, configuration.mode);
  kind = its_kind == TickKind::kSurface ? kind : its_kind;
  pace = pace_of(configuration.rate_hz);
  delta = configuration.device.kind == DeviceKind::kDelta;
  ++bodies;
}

std::uint64_t cycles_of(const TickCost& cost, const TickFigures& figures) {
  std::uint64_t cycles = cost.base;
  for (std::uint32_t i = 0; i < kTickFigures; ++i) {  // bound: kTickFigures
    cycles += static_cast<std::uint64_t>(cost.per_figure[i]) * (figures.*kFigures[i]);
  }
  return cycles;
}

const TickCost& worst_row(const TickCosts& costs, const TickLoad& load) {
  if (load.kind == TickKind::kPaper) {
    return costs.paper;
  }
  const TickCost* const rows =
      costs.surface[static_cast<std::uint32_t>(load.kind)] + first_row(load.pace);
  const TickCost* worst = rows;
  for (std::uint32_t i = 1; i < rows_of_pace(load.pace); ++i) {  // bound: kTickRows
    if (cycles_of(rows[i], load.figures) > cycles_of(*worst, load.figures)) {
      worst = rows + i;
    }
  }
  return *worst;
}

std::uint64_t cycles_of(const TickCosts& costs, const TickLoad& load) {
  const std::uint64_t each = cycles_of(worst_row(costs, load), load.figures);
  return costs.base + (load.delta ? costs.delta : 0U) +
         each * smaller_of(load.bodies, kMaxReachableBodies);
}

TickKind tick_kind(const BlobHeader& header, RenderMode mode) {
  if (mode == RenderMode::kPaper) {
    return TickKind::kPaper;
  }
  const bool is_mixed = header.profile == static_cast<std::uint32_t>(Profile::kPaper);
  return is_mixed ? TickKind::kMixed : TickKind::kSurface;
}

}  // namespace tactree::core
