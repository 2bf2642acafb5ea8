#pragma once
// What a tick takes at most, as a formula in the figures that a blob declares; `tactree bound`
// proves it from the linked image and writes it there. So a controller refuses what would not be in
// time.
//
// Interrupt safety of all that follows: pure functions.

#include <cstdint>

#include "tactree/core/blob_format.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/scene.hpp"
#include "tactree/core/surface.hpp"

namespace tactree::core {

/// Figures of a model that a tick's length depends on. The bounds beside the loops name them.
struct TickFigures {
  std::uint32_t points_per_ball_max = 0;
  std::uint32_t points_per_leaf_max = 0;
  std::uint32_t depth = 0;
  std::uint32_t levels_below = 0;       ///< between the directory and the leaves
  std::uint32_t blended_points = 0;     ///< whose materials are looked at in a contact
  std::uint32_t blended_materials = 0;  ///< that a contact may be of
};
inline constexpr std::uint32_t kTickFigures = sizeof(TickFigures) / sizeof(std::uint32_t);
inline constexpr const char* kTickFigureNames[kTickFigures] = {
    "points_per_ball_max", "points_per_leaf_max", "depth",
    "levels_below",        "blended_points",      "blended_materials"};

[[nodiscard]] TickFigures tick_figures(const BlobHeader& header);

/// Of one body, cycles = base + the sum over the figures of per_figure * figure.
struct TickCost {
  std::uint32_t base = 0;
  std::uint16_t per_figure[kTickFigures] = {};
};
[[nodiscard]] std::uint64_t cycles_of(const TickCost& cost, const TickFigures& figures);

/// Ways through a tick that differ too much for one formula.
enum class TickKind : std::uint32_t {
  kSurface = 0,  ///< surface mode, leaves of one size
  kMixed = 1,    ///< surface mode, leaves of several sizes
  kPaper = 2,
};
inline constexpr std::uint32_t kTickKinds = 3;
[[nodiscard]] TickKind tick_kind(const BlobHeader& header, RenderMode mode);

/// The models of a scene together.
struct TickLoad {
  TickFigures figures{};  ///< of all models the largest
  TickKind kind = TickKind::kSurface;
  std::uint32_t bodies = 0;
  std::uint32_t pace = 0;  ///< of the rate: pace_of()
  bool delta = false;      ///< the device is one
  void add(const BlobHeader& header, const Configuration& configuration);
};

/// A tick of surface mode that gathers more has less left to fit: what it takes depends on how
/// many gathers, of all bodies, it does. One row for each number of them, from none.
[[nodiscard]] constexpr std::uint32_t rows_of_pace(std::uint32_t pace) {
  return kMaxReachableBodies * kWorkPerTick[pace].gathers + 1U;
}
/// The rows of the pace begin after those of all before it.
[[nodiscard]] constexpr std::uint32_t first_row(std::uint32_t pace) {
  std::uint32_t rows = 0;
  for (std::uint32_t before = 0; before < pace; ++before) {  // bound: kPaces
    rows += rows_of_pace(before);
  }
  return rows;
}
inline constexpr std::uint32_t kTickRows = first_row(kPaces);

inline constexpr std::uint32_t kTickCostsKnown = 0x4B434954;  // "TICK"

/// Of an image: cycles = base + delta where the device is one + for each body that is rendered the
/// largest of the rows. Zeros, as compiled: nothing is known.
struct TickCosts {
  std::uint32_t known = 0;
  std::uint32_t base = 0;
  std::uint32_t delta = 0;
  TickCost surface[2][kTickRows] = {};  ///< of leaves of one size, of several
  TickCost paper{};
};
/// Precondition: costs.known is kTickCostsKnown.
[[nodiscard]] std::uint64_t cycles_of(const TickCosts& costs, const TickLoad& load);
/// The costliest of the rows for such a body.
[[nodiscard]] const TickCost& worst_row(const TickCosts& costs, const TickLoad& load);

static_assert(sizeof(TickCost) == 4 + 2 * kTickFigures);
static_assert(sizeof(TickCosts) == 12 + sizeof(TickCost) * (2 * kTickRows + 1));

}  // namespace tactree::core
