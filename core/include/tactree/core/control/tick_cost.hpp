#pragma once
// Upper bound of the cycles of a tick, as a function of the limits that a blob declares. `tactree
// bound` proves the coefficients from the linked image and writes them into it; the controller
// refuses a model whose bound exceeds the period.
//
// Interrupt safe: pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/scene.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob_format.hpp"

namespace tactree::core {

/// Limits of a model that determine the cycles of a tick; the loop bounds in the source refer to
/// them by name.
struct ModelLimits {
  std::uint32_t points_per_ball_max = 0;
  std::uint32_t points_per_support_max = 0;
  std::uint32_t points_per_leaf_max = 0;
  std::uint32_t depth = 0;
  std::uint32_t levels_below = 0;       ///< between the directory and the leaves
  std::uint32_t blended_points = 0;     ///< points whose materials are read for a contact
  std::uint32_t blended_materials = 0;  ///< materials in the blend of a contact
};
inline constexpr std::uint32_t kModelLimits = sizeof(ModelLimits) / sizeof(std::uint32_t);
inline constexpr const char* kModelLimitNames[kModelLimits] = {
    "points_per_ball_max", "points_per_support_max", "points_per_leaf_max", "depth",
    "levels_below",        "blended_points",         "blended_materials"};

[[nodiscard]] ModelLimits model_limits(const BlobHeader& header);

/// A model whose limits are lower costs as much as one with these: near the limits of usual models,
/// the formula is then closer to the bound.
inline constexpr ModelLimits kLeastLimits = {32, 32, 32, 4, 2, 0, 0};
// The formula has the price of a support for points that are also in the ball. Their excess must
// not exceed that of the ball.
static_assert(kLeastLimits.points_per_support_max == kLeastLimits.points_per_ball_max);

/// Cost of one body: cycles = base + sum of per_limit[i] * (limit i - kLeastLimits i).
struct TickCost {
  std::uint32_t base = 0;
  std::uint16_t per_limit[kModelLimits] = {};
  std::uint16_t reserved = 0;
};
[[nodiscard]] std::uint64_t cycles_of(const TickCost& cost, const ModelLimits& limits);

/// Kinds of ticks; each has its own formula.
enum class TickKind : std::uint32_t {
  kSurface = 0,  ///< surface mode, leaves of one size
  kMixed = 1,    ///< surface mode, leaves of several sizes
  kPaper = 2,
};
[[nodiscard]] TickKind tick_kind(const BlobHeader& header, RenderMode mode);

/// The load of all models of a scene.
struct TickLoad {
  ModelLimits limits{};  ///< largest of all models
  TickKind kind = TickKind::kSurface;
  std::uint32_t bodies = 0;
  std::uint32_t work_tier = 0;  ///< add() sets work_tier_of() of the rate
  bool delta = false;           ///< the device is a delta
  void add(const BlobHeader& header, const Configuration& configuration);
};

/// Number of cost rows for a work tier and a number of rendered bodies, 1 to kMaxReachableBodies. A
/// tick of surface mode divides its work between gathering and fitting, so its cost depends on the
/// total number of gathers. There is one row for each number, from 0.
[[nodiscard]] constexpr std::uint32_t rows_of(std::uint32_t work_tier, std::uint32_t bodies) {
  return bodies * kWorkPerTick[work_tier].gathers + 1U;
}
/// Index of the first of these rows. The rows of fewer bodies precede it, then those of earlier
/// tiers.
[[nodiscard]] constexpr std::uint32_t first_row(std::uint32_t work_tier, std::uint32_t bodies) {
  std::uint32_t rows = 0;
  for (std::uint32_t fewer = 1; fewer <= bodies; ++fewer) {  // bound: kMaxReachableBodies
    const std::uint32_t tiers = fewer < bodies ? kWorkTiers : work_tier;
    for (std::uint32_t before = 0; before < tiers; ++before) {  // bound: kWorkTiers
      rows += rows_of(before, fewer);
    }
  }
  return rows;
}
inline constexpr std::uint32_t kTickRows = first_row(kWorkTiers, kMaxReachableBodies);

inline constexpr std::uint32_t kTickCostsKnown = 0x32434954;  // "TIC2"

/// Costs of an image: cycles = base + delta (delta device only) + listed for each body of the scene
/// + most expensive row for each rendered body. A row for several bodies states the cost per body.
/// All values are zero, which means unknown, until they are written into the image.
struct TickCosts {
  std::uint32_t known = 0;
  std::uint32_t base = 0;
  std::uint32_t delta = 0;
  std::uint32_t listed = 0;
  TickCost surface[2][kTickRows] = {};  ///< [0]: leaves of one size, [1]: of several
  TickCost paper{};
};
/// Precondition: costs.known is kTickCostsKnown.
[[nodiscard]] std::uint64_t cycles_of(const TickCosts& costs, const TickLoad& load);
/// First tier, from `load.work_tier` on, at which a tick takes at most `cycles`; kWorkTiers if
/// there is none. Precondition: costs.known is kTickCostsKnown.
[[nodiscard]] std::uint32_t work_tier_in_time(const TickCosts& costs, TickLoad load,
                                              std::uint64_t cycles);
/// Most expensive row for the bodies of `load`. Precondition: load.bodies > 0.
[[nodiscard]] const TickCost& worst_row(const TickCosts& costs, const TickLoad& load);

static_assert(sizeof(TickCost) == 4 + 2 * kModelLimits + 2);
static_assert(sizeof(TickCosts) == 16 + sizeof(TickCost) * (2 * kTickRows + 1));

}  // namespace tactree::core
