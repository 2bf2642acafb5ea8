// Candidates gathered ahead: a proxy at a high rate does not wait for them.

#include "tactree/core/contact/candidate_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "analytic_shapes.hpp"
#include "tactree/core/contact/neighbour.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::test {
namespace {

using core::Vec3;
using Eigen::Vector3d;

constexpr std::uint32_t kHighTier = core::work_tier_of(4000.0F);
constexpr std::uint32_t kLeastTier = core::kWorkTiers - 1U;
static_assert(core::kWorkPerTick[kHighTier].gathers_ahead());
static_assert(!core::kWorkPerTick[kLeastTier].gathers_ahead());

core::GatherSlice slice() { return core::kWorkPerTick[kHighTier].ahead; }

class TwoSets : public testing::Test {
 protected:
  TwoSets() { sets_.use_both(true); }

  /// Gathers on demand at `x`; returns the number of slices.
  int gather_at(Vec3 x) {
    for (int slices = 1; slices < 100; ++slices) {
      core::GatherSlice left = slice();
      sets_.begin_on_demand(shape_.view(), x);
      if (sets_.continue_gather(shape_.view(), left)) {
        return slices;
      }
    }
    return 0;
  }
  /// A slice of a gather ahead of `x`, if it begins.
  bool gather_ahead(Vec3 x, Vec3 travel) {
    const bool begins = sets_.begin_ahead(shape_.view(), x, travel);
    if (begins) {
      core::GatherSlice left = slice();
      (void)sets_.continue_gather(shape_.view(), left);
    }
    return begins;
  }
  bool cover(Vec3 x) { return sets_.in_use().covers(x) || sets_.take_other(x); }

  const Shape shape_ = plane();
  const float slack_ = core::CandidateSet::slack_of(shape_.view());
  core::CandidateSets sets_;
};

TEST_F(TwoSets, WaitOnlyAtFirst) {
  Vec3 x = {-0.02F, 0.001F, 0.0F};
  const Vec3 travel = {0.04e-3F, 0.013e-3F, 0.0F};  // 0.17 m/s at 4 kHz
  int last_wait = 0;
  for (int tick = 0; tick < 300; ++tick) {
    if (!cover(x)) {
      core::GatherSlice left = slice();
      sets_.begin_on_demand(shape_.view(), x);
      (void)sets_.continue_gather(shape_.view(), left);
      last_wait = tick;
      continue;
    }
    ASSERT_GT(sets_.in_use().count(), 20U);
    gather_ahead(x, travel);
    x += travel;
  }
  EXPECT_GT(last_wait, 2);
  EXPECT_LE(last_wait, 20);
  EXPECT_GT(x.x, -0.009F);
}

TEST_F(TwoSets, GatherNothingAtRest) {
  gather_at({});
  EXPECT_FALSE(gather_ahead({}, {}));
  EXPECT_FALSE(gather_ahead({}, {1e-6F, 0.0F, 0.0F})) << "the end is far away";
  EXPECT_TRUE(gather_ahead({}, {0.2e-3F, 0.0F, 0.0F}));
}

// A step longer than the ball of a set: the second set covers its end.
TEST_F(TwoSets, GatherAtEndOfStep) {
  gather_at({});
  const Vec3 step = {2.5F * slack_, 0.0F, 0.0F};
  for (int i = 0; i < 20; ++i) {
    gather_ahead({}, step);
  }
  EXPECT_TRUE(sets_.in_use().covers({})) << "nobody has asked for the second set";
  EXPECT_TRUE(cover(step));
}

TEST_F(TwoSets, AbandonGatherAheadElsewhere) {
  gather_at({});
  gather_ahead({}, {0.2e-3F, 0.0F, 0.0F});
  const Vec3 back = {-1.2F * slack_, 0.0F, 0.0F};
  ASSERT_FALSE(sets_.will_cover(back));
  EXPECT_GT(gather_at(back), 1);
  EXPECT_TRUE(cover(back));
}

TEST_F(TwoSets, ContinueGatherAheadOnDemand) {
  const int whole = gather_at({});
  for (int i = 0; i < 6; ++i) {
    gather_ahead({}, {0.2e-3F, 0.0F, 0.0F});
  }
  const Vec3 next = {1.2F * slack_, 0.0F, 0.0F};
  EXPECT_TRUE(sets_.will_cover(next));
  EXPECT_FALSE(sets_.is_waiting());
  EXPECT_LT(gather_at(next), whole - 3);
}

TEST_F(TwoSets, WaitUntilGatherOnDemandEnds) {
  gather_at({});
  const Vec3 next = {1.2F * slack_, 0.0F, 0.0F};
  core::GatherSlice left = slice();
  sets_.begin_on_demand(shape_.view(), next);
  ASSERT_FALSE(sets_.continue_gather(shape_.view(), left));
  EXPECT_TRUE(sets_.is_waiting());
  EXPECT_TRUE(sets_.in_use().covers({}));
  // A tick in which nobody needs it.
  EXPECT_TRUE(sets_.begin_ahead(shape_.view(), {}, {}));
  EXPECT_FALSE(sets_.is_waiting());
}

TEST_F(TwoSets, KeepSetBehind) {
  gather_at({});
  const Vec3 ahead = {1.2F * slack_, 0.0F, 0.0F};
  gather_at(ahead);
  EXPECT_TRUE(cover(ahead));
  EXPECT_TRUE(cover({})) << "the path turns back";
  sets_.clear();
  EXPECT_FALSE(cover({}));
  EXPECT_FALSE(cover(ahead));
}

// The neighbour of an earlier tick must not hide points in a set that is taken into use.
TEST_F(TwoSets, ShowAllPointsWhenTaken) {
  gather_at({});
  const std::uint32_t all = sets_.in_use().count();
  core::Neighbour neighbour;
  neighbour.face[0] = {{0.0F, 0.0F, 1.0F}, 1.0F};  // all points are behind it
  neighbour.holding = 1;
  sets_.hide(neighbour, 1.0F);
  ASSERT_EQ(sets_.in_use().hidden(), all);
  const Vec3 ahead = {1.2F * slack_, 0.0F, 0.0F};
  gather_at(ahead);
  ASSERT_TRUE(sets_.in_use().covers(ahead));
  EXPECT_TRUE(cover({}));
  EXPECT_EQ(sets_.in_use().hidden(), 0U);
  EXPECT_EQ(sets_.in_use().count(), all);
}

TEST_F(TwoSets, EmptyWhenOneIsEnough) {
  gather_at({});
  sets_.use_both(true);
  EXPECT_TRUE(cover({}));
  sets_.use_both(false);
  EXPECT_FALSE(sets_.in_use().covers({}));
  core::GatherSlice all;
  sets_.begin_on_demand(shape_.view(), {});
  EXPECT_FALSE(sets_.in_use().covers({})) << "one set is gathered in place";
  EXPECT_TRUE(sets_.is_waiting());
  EXPECT_TRUE(sets_.continue_gather(shape_.view(), all));
  EXPECT_TRUE(sets_.in_use().covers({}));
  EXPECT_FALSE(sets_.will_cover({1.2F * slack_, 0.0F, 0.0F}));
}

TEST(TickBudget, RefundsGatherOnlyIfSmall) {
  const core::SurfaceWork& work = core::kWorkPerTick[kHighTier];
  for (const bool small : {true, false}) {
    for (std::uint32_t core::GatherSlice::*const part :
         {&core::GatherSlice::corners, &core::GatherSlice::points,
          &core::GatherSlice::candidates}) {
      core::TickBudget budget;
      budget.begin(work);
      ASSERT_TRUE(budget.allows_fit());
      budget.spend_gather().*part -= work.ahead.*part + (small ? 0U : 1U);
      EXPECT_FALSE(budget.allows_fit());
      budget.refund_small_gather();
      EXPECT_EQ(budget.allows_fit(), small);
    }
  }
}

TEST(TickBudget, GathersAheadOnceAfterFit) {
  core::GatherSlice left;
  core::TickBudget budget;
  budget.begin(core::kWorkPerTick[kHighTier]);
  budget.spend_passes(2);
  EXPECT_FALSE(budget.allows_gather());
  EXPECT_TRUE(budget.spend_ahead(left));
  EXPECT_EQ(left.candidates, slice().candidates);
  EXPECT_FALSE(budget.spend_ahead(left));
  budget.begin(core::kWorkPerTick[kHighTier]);
  (void)budget.spend_gather();
  EXPECT_FALSE(budget.spend_ahead(left));
}

/// A proxy on a sphere, 1 mm deep, at 4 kHz and this tier; the path turns back every `turn` ticks.
struct Distances {
  double rms_m = 0.0;
  double largest_m = 0.0;
  int lost = 0;
};

Distances slide_over_sphere(double speed_m_s, std::uint32_t tier, int turn) {
  const Shape shape = sphere();
  core::Proxy proxy;
  const auto go_to = [&](double angle, double height) {
    const Vector3d along(0.8 * std::sin(angle), 0.6 * std::sin(angle), std::cos(angle));
    proxy.update(shape.view(), narrow((kSphereRadius + height) * along), {},
                 core::kWorkPerTick[tier]);
    return widen(proxy.position()).norm() - kSphereRadius;
  };
  proxy.reset({0.0F, 0.0F, static_cast<float>(kSphereRadius + 0.004)});
  for (double height = 0.004; height > -0.001; height -= 1e-5) {
    go_to(0.0, height);
  }
  Distances result;
  double angle = 0.0;
  double sum = 0.0;
  constexpr int kTicks = 1200;
  for (int tick = 0; tick < kTicks; ++tick) {
    angle += (tick / turn % 2 == 0 ? 1.0 : -1.0) * speed_m_s / 4000.0 / kSphereRadius;
    const double off = go_to(angle, -0.001);
    sum += off * off;
    result.largest_m = std::max(result.largest_m, std::abs(off));
    result.lost += proxy.in_contact() ? 0 : 1;
  }
  result.rms_m = std::sqrt(sum / kTicks);
  std::printf("sphere, %.1f m/s, tier %u, turn %d: rms %.2f um, largest %.2f um, lost %d\n",
              speed_m_s, tier, turn, 1e6 * result.rms_m, 1e6 * result.largest_m, result.lost);
  return result;
}

TEST(GatheringAhead, KeepsFastProxyOnSphere) {
  const Distances ahead = slide_over_sphere(0.5, kHighTier, 10000);
  EXPECT_EQ(ahead.lost, 0);
  EXPECT_LE(ahead.rms_m, 1e-6);
  EXPECT_LE(ahead.largest_m, 3e-6);
  EXPECT_GT(slide_over_sphere(0.5, kLeastTier, 10000).rms_m, 1.5e-6)
      << "without a gather ahead the proxy waits";
}

TEST(GatheringAhead, KeepsContactWherePathTurns) {
  for (const int turn : {7, 23, 60}) {
    const Distances turning = slide_over_sphere(0.5, kHighTier, turn);
    EXPECT_EQ(turning.lost, 0) << turn;
    EXPECT_LE(turning.largest_m, 20e-6) << turn;
  }
}

/// m, depth of a hand at 0.5 m/s and 4 kHz when the contact begins; the largest of several phases.
template <class Distance>
double noticed_at(const Shape& shape, const Vector3d& start, const Vector3d& way,
                  std::uint32_t tier, const Distance& distance) {
  constexpr double kStep = 0.5 / 4000.0;
  double deepest = 0.0;
  for (double phase = 0.0; phase < 1.0; phase += 0.05) {
    core::Proxy proxy;
    Vector3d probe = start + phase * kStep * way;
    proxy.reset(narrow(probe));
    while (!proxy.in_contact() && distance(probe) > -5e-3) {
      probe += kStep * way;
      proxy.update(shape.view(), narrow(probe), {}, core::kWorkPerTick[tier]);
    }
    deepest = std::max(deepest, -distance(probe));
  }
  return deepest;
}

/// The largest depth at which a plane, a sphere and the bottom of grooves are noticed.
double noticed_at(std::uint32_t tier) {
  constexpr double kSpacing_m = 0.5e-3;
  const Vector3d down(0.0, 0.0, -1.0);
  Shape flat(kSpacing_m);
  for (double x = -0.01; x < 0.01; x += kSpacing_m) {
    for (double y = -0.01; y < 0.01; y += kSpacing_m) {
      flat.add({x, y, 0.0}, -down);
    }
  }
  flat.seal();
  const auto height = [](const Vector3d& p) { return p.z(); };
  double deepest = noticed_at(flat, {0.3e-3, 0.1e-3, 8e-3}, down, tier, height);
  std::printf("tier %u: plane noticed at %.3f mm\n", tier, 1e3 * deepest);
  const Shape ball = sphere(0.015, kSpacing_m);
  const auto off_ball = [](const Vector3d& p) { return p.norm() - 0.015; };
  const double round = noticed_at(ball, {0.3e-3, 0.1e-3, 0.023}, down, tier, off_ball);
  std::printf("tier %u: sphere noticed at %.3f mm\n", tier, 1e3 * round);
  deepest = std::max(deepest, round);
  for (const double angle : {75.0, 90.0, 135.0}) {
    const evaluation::Prism prism = evaluation::groove(angle);
    const Shape shape = evaluation::sampled(prism, kSpacing_m, 0.3, 0.0, 7);
    const auto off = [&](const Vector3d& p) { return prism.distance(p); };
    const double crease = noticed_at(shape, {0.3e-3, -1e-3, 6e-3}, down, tier, off);
    std::printf("tier %u: groove %.0f noticed at %.3f mm\n", tier, angle, 1e3 * crease);
    deepest = std::max(deepest, crease);
  }
  return deepest;
}

TEST(GatheringAhead, NoticesSurfaceWithinOneMillimetre) {
  EXPECT_LE(noticed_at(kHighTier), 1e-3);
  EXPECT_GT(noticed_at(kLeastTier), 1e-3) << "without a gather ahead";
}

// Also at the tiers of boards that are too slow for their rate.
TEST(GatheringAhead, MissesNoThinPlate) {
  const Shape shape = plate(0.5 * kSpacing, 0.04);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (std::uint32_t tier = kHighTier; tier < core::kWorkTiers; ++tier) {
    for (const double speed_m_s : {0.02, 0.2, 0.5, 1.0}) {
      for (int i = 0; i < 40; ++i) {
        const double side = unit(random) < 0.0 ? -1.0 : 1.0;
        const Vector3d entry(0.01 * unit(random), 0.01 * unit(random), side * 0.25e-3);
        const Vector3d inward =
            Vector3d(0.5 * unit(random), 0.5 * unit(random), -side).normalized();
        core::Proxy proxy;
        proxy.reset(narrow(entry - 0.01 * inward));
        double s = -0.01;
        for (int waits = 0; waits < 50 && !proxy.in_contact(); waits += s > 0.005 ? 1 : 0) {
          s += s > 0.005 ? 0.0 : speed_m_s / 4000.0;
          proxy.update(shape.view(), narrow(entry + s * inward), {}, core::kWorkPerTick[tier]);
        }
        ASSERT_TRUE(proxy.in_contact()) << "tier " << tier << ", " << speed_m_s << " m/s";
        EXPECT_GT(static_cast<double>(proxy.normal().z) * side, 0.9) << "touched from outside";
      }
    }
  }
}

}  // namespace
}  // namespace tactree::test
