// Edges and corners stay sharp, and a hand that slides over them feels no jump.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "analytic_shapes.hpp"
#include "errors.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/contact/surface.hpp"

namespace tactree::test {
namespace {

constexpr double kHalf = 0.02;
constexpr double kSupport = 2.5 * kSpacing;

/// Signed distance to the cube.
double box_distance(const Eigen::Vector3d& p) {
  const Eigen::Vector3d beyond = p.cwiseAbs() - Eigen::Vector3d::Constant(kHalf);
  const double outside = beyond.cwiseMax(0.0).norm();
  return outside > 0.0 ? outside : beyond.maxCoeff();
}

/// Points moved by a part of a spacing each, so that edges cut the rows anywhere.
Shape irregular_box(unsigned seed) { return box(kHalf, 0.3, seed); }

/// A floor z = 0 and a wall x = 0 that meet in a concave edge; free space is x < 0, z > 0.
Shape floor_and_wall(unsigned seed) {
  Shape shape;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-0.3, 0.3);
  const auto place = [&](int i) { return (i + 0.5 + unit(random)) * kSpacing; };
  for (int i = 0; i < 20; ++i) {
    for (int j = -20; j < 20; ++j) {
      shape.add({-place(i), place(j), 0.0}, Eigen::Vector3d::UnitZ());
      shape.add({0.0, place(j), place(i)}, -Eigen::Vector3d::UnitX());
    }
  }
  shape.seal();
  return shape;
}

/// Probes from the zone of the edges: within a support radius of one, up to 1 mm deep or high.
Errors measure_box(const Shape& shape, bool corners) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto near_face = [&] { return kHalf - kSupport * std::abs(unit(random)); };
  Errors errors;
  for (int i = 0; i < 20'000; ++i) {
    Eigen::Vector3d p;
    p[i % 3] = corners ? std::copysign(near_face(), unit(random))
                       : (kHalf - 2.0 * kSupport) * unit(random);
    p[(i + 1) % 3] = std::copysign(near_face(), unit(random));
    p[(i + 2) % 3] = std::copysign(kHalf + kSpacing * unit(random), unit(random));
    const core::SurfaceProjection found = core::project_to_surface(shape.view(), narrow(p));
    EXPECT_TRUE(found.supported);
    errors.add(box_distance(widen(found.point)));
  }
  return errors;
}

TEST(Edge, StaysSharpOnBox) {
  for (const Shape& shape : {box(kHalf), irregular_box(1), irregular_box(2)}) {
    const Errors errors = measure_box(shape, false);
    EXPECT_LE(errors.rms(), 5e-6);
    EXPECT_LE(errors.largest(), 20e-6);
  }
}

TEST(Edge, StaysAlmostSharpAtCorners) {
  for (const Shape& shape : {box(kHalf), irregular_box(1)}) {
    const Errors errors = measure_box(shape, true);
    EXPECT_LE(errors.rms(), 25e-6);
    EXPECT_LE(errors.largest(), 300e-6);
  }
}

TEST(Edge, StaysSharpIfConcave) {
  const Shape shape = floor_and_wall(1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Errors errors;
  for (int i = 0; i < 10'000; ++i) {
    const Eigen::Vector3d p(-kSupport * std::abs(unit(random)), 0.01 * unit(random),
                            kSpacing * unit(random));
    const core::SurfaceProjection found = core::project_to_surface(shape.view(), narrow(p));
    const Eigen::Vector3d at = widen(found.point);
    EXPECT_TRUE(found.supported);
    errors.add(std::min(std::abs(at.x()), std::abs(at.z())) + std::max(0.0, at.x()) +
               std::max(0.0, -at.z()));
  }
  EXPECT_LE(errors.rms(), 5e-6);
  EXPECT_LE(errors.largest(), 20e-6);
}

/// A hand that goes from place to place at 0.1 m/s.
class SlidingHand {
 public:
  SlidingHand(const Shape& shape, const Eigen::Vector3d& start) : view_(shape.view()), at_(start) {
    proxy_.reset(narrow(start));
  }
  void go(const Eigen::Vector3d& to) {
    const double ticks = std::ceil((to - at_).norm() / kPerTick);
    const Eigen::Vector3d from = at_;
    largest_step_ = 0.0;
    lost_ = 0;
    for (double i = 1.0; i <= ticks; i += 1.0) {
      at_ = from + (to - from) * (i / ticks);
      proxy_.update(view_, narrow(at_), core::Friction{}, core::work_per_tick(1000.0F));
      const Eigen::Vector3d force =
          proxy_.in_contact() ? Eigen::Vector3d(1000.0 * static_cast<double>(proxy_.strength()) *
                                                (widen(proxy_.position()) - at_))
                              : Eigen::Vector3d::Zero();
      largest_step_ = std::max(largest_step_, (force - force_).norm());
      lost_ += proxy_.in_contact() ? 0 : 1;
      force_ = force;
    }
  }
  static constexpr double kPerTick = 1e-4;                   // m
  static constexpr double kLargestStep = 1000.0 * kPerTick;  // N, while the proxy holds still
  [[nodiscard]] double largest_step() const { return largest_step_; }
  [[nodiscard]] int lost() const { return lost_; }
  [[nodiscard]] const Eigen::Vector3d& force() const { return force_; }

 private:
  const core::BlobView& view_;
  Eigen::Vector3d at_;
  core::Proxy proxy_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  double largest_step_ = 0.0;
  int lost_ = 0;
};

TEST(Edge, SlidesSmoothlyIfConvex) {
  for (const Shape& shape : {box(kHalf), irregular_box(1), irregular_box(2)}) {
    for (const double depth : {2e-4, 1e-3}) {
      SlidingHand hand(shape, {kHalf - 0.006, 0.0031, kHalf + 0.004});
      hand.go({kHalf - 0.006, 0.0031, kHalf - depth});
      hand.go({kHalf - depth, 0.0031, kHalf - depth});
      EXPECT_EQ(hand.lost(), 0);
      EXPECT_LE(hand.largest_step(), 0.02);
      EXPECT_NEAR(hand.force().z(), 1000.0 * depth, 0.01);
    }
  }
}

TEST(Edge, SlidesSmoothlyIfConcave) {
  for (const unsigned seed : {1U, 2U}) {
    const Shape shape = floor_and_wall(seed);
    for (const double depth : {2e-4, 1e-3}) {
      SlidingHand hand(shape, {-0.008, 0.0031, 0.004});
      hand.go({-0.008, 0.0031, -depth});
      hand.go({depth, 0.0031, -depth});
      EXPECT_EQ(hand.lost(), 0);
      EXPECT_LE(hand.largest_step(), 1.1 * SlidingHand::kLargestStep);
      EXPECT_NEAR(hand.force().z(), 1000.0 * depth, 0.01);
      EXPECT_NEAR(hand.force().x(), -1000.0 * depth, 0.01);
    }
  }
}

}  // namespace
}  // namespace tactree::test
