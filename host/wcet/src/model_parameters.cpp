#include "model_parameters.hpp"

#include "tactree/core/control/tick_cost.hpp"
#include "tactree/wcet/bound.hpp"

namespace tactree::wcet {

Parameters parameters_of(const core::ModelLimits& limits, core::TickKind kind, std::uint32_t bodies,
                         bool delta) {
  return {{"points_per_ball_max", limits.points_per_ball_max},
          {"points_per_support_max", limits.points_per_support_max},
          {"points_per_leaf_max", limits.points_per_leaf_max},
          {"points_per_query_max", core::kLeavesPerQuery * kMaxLeafPoints},
          {"points_per_slab_max", core::kLeavesPerQuery * kMaxLeafPoints},
          {"depth", limits.depth},
          {"levels_below", limits.levels_below},
          {"blended_points", limits.blended_points},
          {"blended_materials", limits.blended_materials},
          {"delta", delta ? 1 : 0},
          {"bodies", bodies},
          {"listed", bodies},
          {"mixed", kind == core::TickKind::kSurface ? 0 : 1},
          {"paper", kind == core::TickKind::kPaper ? 1 : 0}};
}

Parameters parameters_of(const core::BlobHeader& header, core::RenderMode mode,
                         std::uint32_t bodies, core::DeviceKind device) {
  Parameters parameters = parameters_of(core::model_limits(header), core::tick_kind(header, mode),
                                        bodies, device == core::DeviceKind::kDelta);
  parameters["points_per_query_max"] = header.points_per_query_max;
  parameters["points_per_slab_max"] = header.points_per_slab_max;
  return parameters;
}

core::ModelLimits largest_model_limits() {
  core::BlobHeader header{};
  header.depth = core::kMaxDepth;
  header.material_count = core::kMaxMaterials;
  header.points_per_leaf_max = (1U << core::kLeafHalvings) - 1U;
  header.points_per_ball_max = core::kMaxCandidates;
  return core::model_limits(header);
}

}  // namespace tactree::wcet
