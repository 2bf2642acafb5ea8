// A hand that starts in the material of a body: no force until it has left, and never inwards.

#include <gtest/gtest.h>

#include <random>

#include "analytic_shapes.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/contact/surface_work.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::test {
namespace {

using Eigen::Vector3d;

/// Leads a proxy along a path and counts what must not happen.
class InnerHand {
 public:
  InnerHand(const Shape& shape, double rate_hz)
      : view_(shape.view()), work_(core::work_per_tick(static_cast<float>(rate_hz))) {}

  void to(const Vector3d& probe) {
    if (first_) {
      proxy_.reset(narrow(probe));
      first_ = false;
    }
    proxy_.update(view_, narrow(probe), {0.3F, 0.2F}, work_);
  }
  void go(const Vector3d& from, const Vector3d& to_place, double step_m) {
    const int ticks = 1 + static_cast<int>((to_place - from).norm() / step_m);
    for (int i = 0; i <= ticks; ++i) {
      to(from + (to_place - from) * (static_cast<double>(i) / ticks));
      contacts += proxy_.in_contact() ? 1 : 0;
      insides += proxy_.inside() ? 1 : 0;
    }
  }
  void rest(const Vector3d& at, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      to(at);
    }
  }
  [[nodiscard]] const core::Proxy& proxy() const { return proxy_; }

  int contacts = 0;
  int insides = 0;

 private:
  const core::BlobView& view_;
  const core::SurfaceWork& work_;
  core::Proxy proxy_;
  bool first_ = true;
};

Vector3d any_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random);
  const double y = normal(random);
  return Vector3d(x, y, normal(random)).normalized();
}

constexpr double kInnerRates[] = {1000.0, 2000.0, 4000.0};

/// Out of the body from anywhere inside, and back: never held, then felt.
void leave_and_return(const Shape& shape, double radius_m, double inner_m, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 240; ++i) {
    const double rate_hz = kInnerRates[i % 3];
    const double speed = i % 2 == 0 ? 0.1 : 0.8;
    const Vector3d from = inner_m * unit(random) * any_direction(random);
    const Vector3d out = 2.0 * radius_m * any_direction(random);
    InnerHand hand(shape, rate_hz);
    hand.rest(from, 20);
    ASSERT_FALSE(hand.proxy().in_contact()) << i;
    ASSERT_TRUE(hand.proxy().inside()) << i << " from " << from.transpose();
    hand.go(from, out, speed / rate_hz);
    ASSERT_EQ(hand.contacts, 0) << i << " from " << from.transpose() << " to " << out.transpose();
    hand.rest(out, 50);
    ASSERT_FALSE(hand.proxy().inside()) << i;
    hand.go(out, {0.0, 0.0, 0.0}, 0.1 / rate_hz);
    ASSERT_GT(hand.contacts, 0) << i;
    ASSERT_FALSE(hand.proxy().from_behind()) << i;
  }
}

TEST(Inside, LeavesBallWithoutForce) { leave_and_return(sphere(0.015), 0.015, 0.0149, 1); }

TEST(Inside, LeavesCubeInAnyDirection) { leave_and_return(box(0.0125, 0.2), 0.022, 0.0120, 2); }

TEST(Inside, LeavesPlateThinnerThanSpacing) {
  const Shape shape = plate(0.5 * kSpacing);
  for (const double side : {-1.0, 1.0}) {
    InnerHand hand(shape, 1000.0);
    hand.rest({1e-3, 2e-3, 0.0}, 3);
    EXPECT_TRUE(hand.proxy().inside());
    hand.go({1e-3, 2e-3, 0.0}, {1e-3, 2e-3, side * 0.01}, 5e-5);
    EXPECT_EQ(hand.contacts, 0);
    EXPECT_FALSE(hand.proxy().inside());
    hand.go({1e-3, 2e-3, side * 0.01}, {1e-3, 2e-3, -side * 0.001}, 5e-5);
    EXPECT_TRUE(hand.proxy().in_contact());
    EXPECT_NEAR(static_cast<double>(hand.proxy().normal().z), side, 1e-2);
  }
}

TEST(Inside, TreatsRoomAsOutside) {
  const Shape shape = room(0.015, kSpacing, 0.2, 3);
  InnerHand hand(shape, 1000.0);
  hand.rest({0.0, 0.0, 0.0}, 3);
  EXPECT_FALSE(hand.proxy().inside());
  hand.go({0.0, 0.0, 0.0}, {0.0, 0.0, 0.016}, 1e-4);
  EXPECT_TRUE(hand.proxy().in_contact());
  InnerHand behind(shape, 1000.0);  // in the wall
  behind.rest({0.0, 0.0, 0.0165}, 3);
  EXPECT_TRUE(behind.proxy().inside());
  behind.go({0.0, 0.0, 0.0165}, {0.0, 0.0, 0.0}, 1e-4);
  EXPECT_EQ(behind.contacts, 0);
}

TEST(Inside, TreatsSheetSidesAsOutside) {
  const Shape shape = plane();
  for (const double side : {-1.0, 1.0}) {
    InnerHand hand(shape, 1000.0);
    hand.rest({1e-3, 2e-3, side * 5e-4}, 3);
    EXPECT_FALSE(hand.proxy().inside());
    hand.go({1e-3, 2e-3, side * 5e-4}, {1e-3, 2e-3, -side * 5e-4}, 5e-5);
    EXPECT_TRUE(hand.proxy().in_contact());
  }
}

// A hand that lost its contact deep in a body is not pulled further in when it comes out.
TEST(Inside, LeavesWithoutForceAfterJump) {
  const Shape shape = sphere(0.015);
  InnerHand hand(shape, 1000.0);
  hand.rest({0.0, 0.0, 0.03}, 3);
  EXPECT_FALSE(hand.proxy().inside());
  core::Proxy proxy = hand.proxy();
  proxy.reset({0.0F, 0.0F, 0.014F});
  int inside = 0;
  for (double z = 0.014; z < 0.03; z += 1e-4) {
    proxy.update(shape.view(), narrow(Vector3d(0.0, 0.0, z)), {}, core::work_per_tick(1000.0F));
    EXPECT_FALSE(proxy.in_contact()) << z;
    inside += proxy.inside() ? 1 : 0;
  }
  EXPECT_GE(inside, 9);
  EXPECT_FALSE(proxy.inside());
}

// As in a blob of format 1.0.
TEST(Inside, TreatsMissingInteriorAsOutside) {
  Shape shape = sphere(0.015);
  shape.model().tells_interior = false;
  shape.seal();
  InnerHand hand(shape, 1000.0);
  hand.rest({0.0, 0.0, 0.0145}, 3);
  EXPECT_FALSE(hand.proxy().inside());
  hand.go({0.0, 0.0, 0.0145}, {0.0, 0.0, 0.0155}, 5e-5);
  EXPECT_TRUE(hand.proxy().from_behind());
}

}  // namespace
}  // namespace tactree::test
