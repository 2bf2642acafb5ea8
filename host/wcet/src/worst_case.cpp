// The bound of a tick: the worst of all divisions of its work.
#include <algorithm>
#include <utility>

#include "tactree/wcet/bound.hpp"
#include "tick_analysis.hpp"

namespace tactree::wcet {
namespace {

std::vector<Parameters> all_divided(const Parameters& parameters, std::uint32_t work_tier) {
  std::vector<Parameters> all;
  const auto given = parameters.find("bodies");
  const auto bodies = static_cast<std::uint32_t>(given == parameters.end() ? 1 : given->second);
  for (const Division& division :
       divisions(work_tier, std::min(bodies, core::kMaxReachableBodies))) {
    all.push_back(divided(parameters, work_tier, division));
  }
  return all;
}

WorkTierCycles cycles_by_work_tier(TickAnalysis& tick, const BoundOptions& options) {
  WorkTierCycles cycles{};
  for (std::uint32_t work_tier = 0; work_tier < core::kWorkTiers; ++work_tier) {
    for (const Parameters& parameters : all_divided(options.parameters, work_tier)) {
      cycles[work_tier] = std::max(cycles[work_tier],
                                   static_cast<double>(tick.cycles(parameters, *options.timing)));
    }
  }
  return cycles;
}

}  // namespace

std::vector<EntryPoint> tick_entries() { return {{"tactree_tick", 1}, {"tactree_deadline", 2}}; }

std::vector<Division> divisions(std::uint32_t work_tier, std::uint32_t bodies) {
  const core::SurfaceWork& work = core::kWorkPerTick[work_tier];
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
        sum.fits_of_one = std::max({sum.fits_of_one, all[others].fits_of_one, fits});
      }
    }
    all = std::move(more);
  }
  if (work.gathers_ahead()) {
    for (Division& division : all) {
      division.ahead = bodies - division.gathers;
    }
  }
  return all;
}

Bound worst_case(const BoundOptions& options) {
  TickAnalysis tick(options);
  Bound worst;
  for (const Parameters& parameters : all_divided(options.parameters, options.work_tier)) {
    Bound bound = tick.instructions(parameters);
    if (bound.instructions > worst.instructions) {
      worst = std::move(bound);
      worst.parameters = parameters;
    }
  }
  if (options.timing != nullptr) {
    worst.work_tier_cycles = cycles_by_work_tier(tick, options);
    worst.cycles = static_cast<std::uint64_t>(worst.work_tier_cycles[options.work_tier]);
  }
  return worst;
}

double highest_rate(double clock_hz, const WorkTierCycles& cycles) {
  double highest = 0.0;
  for (std::uint32_t tier = 0; tier < core::kWorkTiers; ++tier) {
    const double rate = clock_hz / cycles[tier];
    const bool is_last = tier + 1 == core::kWorkTiers;
    const double end = is_last ? rate : static_cast<double>(core::kWorkTierRates[tier + 1]);
    highest = std::max(highest, std::min(rate, end));
  }
  return highest;
}

std::uint32_t work_tier_in_time(double rate_hz, double clock_hz, const WorkTierCycles& cycles) {
  std::uint32_t tier = core::work_tier_of(static_cast<float>(rate_hz));
  while (tier + 1 < core::kWorkTiers && cycles[tier] * rate_hz > clock_hz) {
    ++tier;
  }
  return tier;
}

}  // namespace tactree::wcet
