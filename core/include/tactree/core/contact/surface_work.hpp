#pragma once
// The surface work of one tick: limits per work tier, in descending order.
//
// A gather decodes the candidate points around a position. A pass visits each decoded point once; a
// fit at a crease costs two passes. The work of a tick is a fraction of the work allowed per second
// and decreases as the rate rises. The last tier still allows a slice of a gather or one fit at a
// crease, but not both. A board that is too slow for the tier of its rate uses a later tier, so
// that it keeps every rate below its maximum: Admission::work_tier().
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
  GatherSlice slice{};
};
/// A whole gather takes about 6000 instructions on a Cortex-M, a pass about 2400.
inline constexpr std::uint32_t kGatherWork = 2;

inline constexpr std::uint32_t kWorkTiers = 3;
/// With a whole gather and two fits at a crease in one tick of the last tier, the bound of a tick
/// at 4 kHz was 40 755 instructions (Stanford bunny, 0.5 mm) instead of 16 549; a period of an
/// STM32F405 has 42 000 cycles. With three corners per tick, a gather takes three ticks.
inline constexpr SurfaceWork kWorkPerTick[kWorkTiers] = {
    {4, 10, 13, {24, 288, 104}}, {2, 4, 4, {16, 160, 56}}, {1, 2, 2, {3, 48, 16}}};
/// A tier applies to rates above its entry, Hz.
inline constexpr float kWorkTierRates[kWorkTiers] = {0.0F, 1000.0F, 2000.0F};

/// Tier of a rate in Hz: 0 .. kWorkTiers - 1.
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
