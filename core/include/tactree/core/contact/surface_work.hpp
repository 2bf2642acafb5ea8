#pragma once
// The surface work of one tick: limits per work tier, in descending order.
//
// A gather decodes the candidate points around a position. A pass visits each decoded point once; a
// fit at a crease costs two passes. The work of a tick is a fraction of the work allowed per second
// and decreases as the rate rises. Above 2 kHz it is one fit, also at a crease, and beside it a
// slice of a gather ahead of the proxy; or, where candidates for a fit are missing, most of a
// gather. A board that is too slow for the tier of its rate uses a later tier, so that it keeps
// every rate below its maximum: Admission::work_tier(). In the last two tiers a tick with a fit
// gathers nothing.
//
// Interrupt safety: constants and pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

namespace tactree::core {

/// Limits for the sum of all gathers of one tick.
struct GatherSlice {
  std::uint32_t corners = 8;     ///< corners of the query cube visited; each has at most one leaf
  std::uint32_t points = 65536;  ///< points compared with the ball
  std::uint32_t candidates = 65536;  ///< points decoded
};

/// Limits of one tick. Work beyond them continues in the next tick.
struct SurfaceWork {
  std::uint32_t gathers = 0;  ///< calls of CandidateSet::gather()
  std::uint32_t passes = 0;   ///< 1 per fit, 2 at a crease; 1 per search for the nearest candidate
  std::uint32_t all = 0;      ///< gathers and passes, a gather counted as kGatherWork passes
  GatherSlice slice{};        ///< of gathers on demand
  /// Of a gather ahead of the proxy, which costs neither passes nor `all`. A gather on demand that
  /// takes no more than this counts as one ahead. Without corners: no gathers ahead.
  GatherSlice ahead{};

  [[nodiscard]] constexpr bool gathers_ahead() const { return ahead.corners != 0U; }
};
/// A whole gather takes about 6000 instructions on a Cortex-M, a pass about 2400.
inline constexpr std::uint32_t kGatherWork = 2;

inline constexpr std::uint32_t kWorkTiers = 5;
inline constexpr GatherSlice kNoSlice{0, 0, 0};
/// The third tier fits into the 42 000 cycles of a period of an STM32F405 at 4 kHz (docs/BOUND.md).
/// With a whole gather and two fits at a crease in one tick, the admission formula exceeds them.
/// The 8 corners of a gather on demand take one tick in the third tier if the points and candidates
/// of the slice suffice, two in the fourth and three in the last.
inline constexpr SurfaceWork kWorkPerTick[kWorkTiers] = {{4, 10, 13, {24, 288, 104}, kNoSlice},
                                                         {2, 4, 4, {16, 160, 56}, kNoSlice},
                                                         {1, 2, 2, {8, 112, 32}, {1, 32, 10}},
                                                         {1, 2, 2, {6, 92, 28}, kNoSlice},
                                                         {1, 2, 2, {3, 48, 16}, kNoSlice}};
/// A tier applies to rates above its entry, Hz. The last two apply to no rate.
inline constexpr float kNoRate = 3.4e38F;
inline constexpr float kWorkTierRates[kWorkTiers] = {0.0F, 1000.0F, 2000.0F, kNoRate, kNoRate};

/// Tier of a rate in Hz: 0, 1 or 2.
[[nodiscard]] constexpr std::uint32_t work_tier_of(float rate_hz) {
  return rate_hz > kWorkTierRates[2] ? 2U : (rate_hz > kWorkTierRates[1] ? 1U : 0U);
}
/// Limits at the tier of the rate, or at `least_tier` if that is later.
[[nodiscard]] constexpr const SurfaceWork& work_per_tick(float rate_hz,
                                                         std::uint32_t least_tier = 0) {
  const std::uint32_t tier = work_tier_of(rate_hz);
  return kWorkPerTick[tier < least_tier ? least_tier : tier];  // memory: flash
}

}  // namespace tactree::core
