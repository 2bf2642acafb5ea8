// The bound as the formula with which a board admits models: core::TickCosts.
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "model_parameters.hpp"
#include "tactree/wcet/bound.hpp"
#include "tactree/wcet/bound_error.hpp"
#include "tick_analysis.hpp"

namespace tactree::wcet {
namespace {

// Of core::kModelLimitNames.
constexpr std::uint32_t kBall = 0;
constexpr std::uint32_t kSupport = 1;

/// Limits of a typical model of a scan, near which the formula is tight.
core::ModelLimits typical_model_limits() { return {46, 33, 50, 7, 3, 46, 4}; }

OpenParameters open_parameters() {
  OpenParameters open{{{"delta", 0}, {"listed", 0}}, {{"delta", 1}, {"listed", core::kMaxBodies}}};
  const Parameters least = parameters_of(core::kLeastLimits, core::TickKind::kSurface, 1, false);
  const Parameters largest =
      parameters_of(largest_model_limits(), core::TickKind::kSurface, 1, true);
  for (const char* const name : core::kModelLimitNames) {
    open.least[name] = least.at(name);
    open.largest[name] = largest.at(name);
  }
  open.largest["points_per_leaf_max"] = kMaxLeafPoints;
  return open;
}

/// Formulas of a whole tick, for each number of bodies that are rendered.
class TickFormulas {
 public:
  TickFormulas(TickAnalysis& tick, const BoardTiming& timing) : tick_(tick), timing_(timing) {}

  /// Cycles of a tick without a body.
  [[nodiscard]] double base() { return of(core::TickKind::kPaper, 0, 0, {}).base; }

  [[nodiscard]] CostFormula of(core::TickKind kind, std::uint32_t bodies, std::uint32_t work_tier,
                               const Division& division) {
    const Parameters parameters =
        divided(parameters_of(typical_model_limits(), kind, bodies, false), work_tier, division);
    CostFormula formula = tick_.formula(parameters, open_parameters(), timing_);
    delta_ = std::max(delta_, formula.per["delta"]);
    listed_ = std::max(listed_, formula.per["listed"]);
    return formula;
  }

  /// Maximum cost of a delta device in all formulas so far.
  [[nodiscard]] double delta() const { return delta_; }
  /// Maximum cost of one body of the scene, rendered or not, in all formulas so far.
  [[nodiscard]] double listed() const { return listed_; }

 private:
  TickAnalysis& tick_;
  const BoardTiming& timing_;
  double delta_ = 0.0;
  double listed_ = 0.0;
};

/// Raises `cost` to the cost of one of `bodies` bodies in the formula.
void cover(core::TickCost& cost, const CostFormula& formula, double base, double listed,
           std::uint32_t bodies) {
  const auto raise = [](auto& to, double share) {
    const double each = std::ceil(std::max(share, 0.0));
    if (each > std::numeric_limits<std::decay_t<decltype(to)>>::max()) {
      throw BoundError(
          "a coefficient of the tick's cost does not fit in 16 bits (widen core::TickCost)");
    }
    to = std::max(to, static_cast<std::decay_t<decltype(to)>>(each));
  };
  const auto share_of = [&](std::uint32_t limit) {
    const auto found = formula.per.find(core::kModelLimitNames[limit]);
    return found == formula.per.end() ? 0.0 : found->second / bodies;
  };
  // Each body is charged with `listed`, which may exceed its price in this formula; the base is
  // lower by the difference.
  raise(cost.base, (formula.base - base) / bodies - (listed - formula.per.at("listed")));
  // The points in the support are part of those in the ball. A point there has the price of both:
  // one path may be the most expensive in the ball, and another one in the support.
  std::uint16_t& of_ball = cost.per_limit[kBall];
  auto in_support = static_cast<std::uint16_t>(of_ball + cost.per_limit[kSupport]);
  raise(of_ball, share_of(kBall));
  raise(in_support, share_of(kBall) + share_of(kSupport));
  cost.per_limit[kSupport] = static_cast<std::uint16_t>(std::max(in_support, of_ball) - of_ball);
  for (std::uint32_t i = kSupport + 1U; i < core::kModelLimits; ++i) {
    raise(cost.per_limit[i], share_of(i));
  }
}

}  // namespace

core::TickCosts tick_costs(const BoundOptions& options) {
  if (options.timing == nullptr) {
    throw BoundError(options.image.string() +
                     ": costs need the timing of a board (name the board)");
  }
  TickAnalysis tick(options);
  TickFormulas formulas(tick, *options.timing);
  core::TickCosts costs;
  costs.known = core::kTickCostsKnown;
  const double base = std::floor(formulas.base());
  // One cycle more: the solver rounds, and a bound is rounded up.
  costs.base = static_cast<std::uint32_t>(base) + 1U;
  struct Row {
    core::TickCost& cost;
    CostFormula formula;
    std::uint32_t bodies;
  };
  std::vector<Row> rows;
  for (std::uint32_t bodies = 1; bodies <= core::kMaxReachableBodies; ++bodies) {
    for (std::uint32_t work_tier = 0; work_tier < core::kWorkTiers; ++work_tier) {
      for (const Division& division : divisions(work_tier, bodies)) {
        const std::uint32_t row = core::first_row(work_tier, bodies) + division.gathers;
        for (const core::TickKind kind : {core::TickKind::kSurface, core::TickKind::kMixed}) {
          rows.push_back({costs.surface[static_cast<std::uint32_t>(kind)][row],
                          formulas.of(kind, bodies, work_tier, division), bodies});
        }
      }
    }
    rows.push_back({costs.paper, formulas.of(core::TickKind::kPaper, bodies, 0, {}), bodies});
  }
  for (const Row& row : rows) {
    cover(row.cost, row.formula, base, formulas.listed(), row.bodies);
  }
  costs.delta = static_cast<std::uint32_t>(std::ceil(formulas.delta()));
  costs.listed = static_cast<std::uint32_t>(std::ceil(formulas.listed()));
  return costs;
}

}  // namespace tactree::wcet
