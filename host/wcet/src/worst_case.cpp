// The bound of a tick: the worst of all divisions of its work.
#include <algorithm>
#include <utility>

#include "tactree/wcet/bound.hpp"
#include "tick_analysis.hpp"

namespace tactree::wcet {
namespace {

std::vector<Parameters> all_divided(const Parameters& parameters, std::uint32_t rate_tier) {
  std::vector<Parameters> all;
  const auto given = parameters.find("bodies");
  const auto bodies = static_cast<std::uint32_t>(given == parameters.end() ? 1 : given->second);
  for (const Division& division :
       divisions(rate_tier, std::min(bodies, core::kMaxReachableBodies))) {
    all.push_back(divided(parameters, rate_tier, division));
  }
  return all;
}

RateTierCycles cycles_by_rate_tier(TickAnalysis& tick, const BoundOptions& options) {
  RateTierCycles cycles{};
  for (std::uint32_t rate_tier = 0; rate_tier < core::kRateTiers; ++rate_tier) {
    for (const Parameters& parameters : all_divided(options.parameters, rate_tier)) {
      cycles[rate_tier] = std::max(cycles[rate_tier],
                                   static_cast<double>(tick.cycles(parameters, *options.timing)));
    }
  }
  return cycles;
}

}  // namespace

std::vector<EntryPoint> tick_entries() { return {{"tactree_tick", 1}, {"tactree_deadline", 2}}; }

std::vector<Division> divisions(std::uint32_t rate_tier, std::uint32_t bodies) {
  const core::SurfaceWork& work = core::kWorkPerTick[rate_tier];
  std::vector<Division> all(1);
  for (std::uint32_t body = 0; body < bodies; ++body) {
    std::vector<Division> more(all.size() + work.gathers);
    for (std::uint32_t others = 0; others < all.size(); ++others) {
      for (std::uint32_t gathers = 0; gathers <= work.gathers; ++gathers) {
        const std::uint32_t left = work.all - std::min(work.all, core::kGatherWork * gathers);
        const std::uint32_t passes = std::min(work.passes, left);
        const std::uint32_t fits = std::max(passes, 1U) - 1U;
        Division& sum = more[others + gathers];
        sum.gathers = others + gathers;
        sum.passes = std::max(sum.passes, all[others].passes + passes);
        sum.fits = std::max(sum.fits, all[others].fits + fits);
        sum.searches = std::max(sum.searches, all[others].searches + std::min(fits, work.gathers));
      }
    }
    all = std::move(more);
  }
  return all;
}

Bound worst_case(const BoundOptions& options) {
  TickAnalysis tick(options);
  Bound worst;
  for (const Parameters& parameters : all_divided(options.parameters, options.rate_tier)) {
    Bound bound = tick.instructions(parameters);
    if (bound.instructions > worst.instructions) {
      worst = std::move(bound);
      worst.parameters = parameters;
    }
  }
  if (options.timing != nullptr) {
    worst.rate_tier_cycles = cycles_by_rate_tier(tick, options);
    worst.cycles = static_cast<std::uint64_t>(worst.rate_tier_cycles[options.rate_tier]);
  }
  return worst;
}

double highest_rate(double clock_hz, const RateTierCycles& cycles) {
  double below = clock_hz;
  for (std::uint32_t rate_tier = core::kRateTiers; rate_tier-- > 0;) {
    const double rate = std::min(clock_hz / cycles[rate_tier], below);
    const double lowest = static_cast<double>(core::kRateTierRates[rate_tier]);
    if (rate > lowest) {
      return rate;
    }
    below = lowest;
  }
  return 0.0;
}

}  // namespace tactree::wcet
