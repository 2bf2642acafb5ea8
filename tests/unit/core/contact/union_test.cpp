// Bodies that touch or overlap are felt as one: no seam, no face within another body, one force.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "scene_rig.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::test {
namespace {

using core::ModelStatus;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using evaluation::Prism;
using evaluation::sampled;

/// A block in the frame of the scene, x and z in mm; along y it is open.
struct Block {
  double x_min;
  double x_max;
  double z_min;
  double z_max;
  double spacing = 0.5e-3;
  unsigned seed = 1;
  /// Of the model's frame in that of the block; the model itself is turned the other way.
  Isometry3d placed = Isometry3d::Identity();

  [[nodiscard]] Shape shape() const {
    Prism prism;
    prism.profile = {{1e-3 * x_min, 1e-3 * z_min},
                     {1e-3 * x_max, 1e-3 * z_min},
                     {1e-3 * x_max, 1e-3 * z_max},
                     {1e-3 * x_min, 1e-3 * z_max}};
    Shape flat = sampled(prism, spacing, 0.3, 0.0, seed);
    if (placed.isApprox(Isometry3d::Identity())) {
      return flat;
    }
    Shape turned(spacing);
    const Isometry3d back = placed.inverse();
    for (std::size_t i = 0; i < flat.model().positions.size(); ++i) {
      turned.add(back * flat.model().positions[i].cast<double>(),
                 back.linear() * flat.model().normals[i].cast<double>());
    }
    turned.seal();
    return turned;
  }
};

struct Placed {
  const Shape& shape;
  Isometry3d pose = Isometry3d::Identity();
};

/// A hand that goes through a scene whose frame is turned by `turn`.
class Course {
 public:
  Course(const std::vector<Placed>& bodies, const Isometry3d& turn, float rate_hz)
      : turn_(turn), rate_hz_(rate_hz) {
    rig_.configuration.rate_hz = rate_hz;
    for (const Placed& body : bodies) {
      numbers_.push_back(rig_.add(body.shape, turn * body.pose));
    }
  }

  /// Places in mm.
  void start(const Vector3d& at) {
    at_ = 1e-3 * at;
    for (int i = 0; i < 5; ++i) {
      tick();
    }
  }
  template <class Each>
  void go(const Vector3d& to, double speed, const Each& each) {
    const Vector3d begin = at_;
    const Vector3d end = 1e-3 * to;
    const auto ticks =
        std::max(1L, std::lround((end - begin).norm() / speed * static_cast<double>(rate_hz_)));
    for (long i = 1; i <= ticks; ++i) {
      at_ = begin + (static_cast<double>(i) / static_cast<double>(ticks)) * (end - begin);
      tick();
      each();
    }
  }
  void go(const Vector3d& to, double speed) {
    go(to, speed, [] {});
  }

  /// In the frame of the blocks; N, mm.
  [[nodiscard]] Vector3d force() const { return turn_.linear().transpose() * rig_.force(); }
  [[nodiscard]] Vector3d proxy() const {
    return 1e3 * (turn_.inverse() * widen(rig_.last.contact.proxy));
  }
  [[nodiscard]] bool feels() const { return rig_.last.contact.in_contact; }
  [[nodiscard]] Vector3d hand() const { return 1e3 * at_; }
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] SceneRig& rig() { return rig_; }
  [[nodiscard]] std::uint32_t number(std::size_t i) const { return numbers_[i]; }

 private:
  void tick() {
    const Vector3d before = rig_.force();
    rig_.tick(turn_ * at_);
    step_ = (rig_.force() - before).norm();
  }

  std::vector<std::uint32_t> numbers_;
  SceneRig rig_;
  Isometry3d turn_;
  float rate_hz_;
  Vector3d at_ = Vector3d::Zero();
  double step_ = 0.0;
};

struct Slide {
  double largest_step = 0.0;  // N
  double furthest = 0.0;      // N, of the force from where it should be
  int lost = 0;
};

/// Goes down to `depth` mm below z = 0 at x = from, and along to x = to.
template <class Expected>
Slide slide_over(Course& course, double from, double to, double depth, double speed, double y,
                 const Expected& expected) {
  Slide slide;
  course.start({from, y, 4.0});
  course.go({from, y, -depth}, 0.1);
  course.go({to, y, -depth}, speed, [&] {
    slide.largest_step = std::max(slide.largest_step, course.step());
    slide.lost += course.feels() ? 0 : 1;
    slide.furthest = std::max(slide.furthest, (course.force() - expected(course.hand())).norm());
  });
  return slide;
}

Vector3d up(const Vector3d& hand) { return {0.0, 0.0, -kWall * 1e-3 * hand.z()}; }

/// The free side is above z = 0 and left of x = wall mm.
auto corner(double wall) {
  return [wall](const Vector3d& hand) -> Vector3d {
    return 1e-3 * kWall * Vector3d(std::min(0.0, wall - hand.x()), 0.0, -hand.z());
  };
}

struct Case {
  const char* name;
  Block left;
  Block right;
  double to;  // mm
  std::function<Vector3d(const Vector3d&)> expected;
  double furthest;  // N
};

void expect_slides(const Case& c) {
  RandomPoses random(31);
  const Shape left = c.left.shape();
  for (const bool turned : {false, true}) {
    Block block = c.right;
    block.placed = turned ? random.pose(0.05) : Isometry3d::Identity();
    const Shape right = block.shape();
    for (const float rate_hz : {1000.0F, 2000.0F, 4000.0F}) {
      for (const double speed : {0.02, 0.3}) {
        SCOPED_TRACE(testing::Message() << c.name << ", " << rate_hz << " Hz, " << speed << " m/s"
                                        << (turned ? ", turned" : ""));
        const Isometry3d turn = turned ? random.pose(0.1) : Isometry3d::Identity();
        Course course({{left}, {right, block.placed}}, turn, rate_hz);
        for (const double depth : {0.5, 3.0}) {
          const Slide slide = slide_over(course, -9.0, c.to, depth, speed, 0.7, c.expected);
          EXPECT_EQ(slide.lost, 0) << depth << " mm";
          const double of_a_tick = kWall * speed / static_cast<double>(rate_hz);
          EXPECT_LT(slide.furthest, c.furthest + of_a_tick) << depth << " mm";
          EXPECT_LT(slide.largest_step, 1.03 * of_a_tick + 0.007) << depth << " mm";
          course.go({c.to, 0.7, 12.0}, 0.3);
        }
      }
    }
  }
}

TEST(Union, HidesFlushSeam) {
  expect_slides({"flush", {-20.0, 0.0, -20.0, 0.0}, {0.0, 20.0, -20.0, 0.0}, 8.0, up, 0.01});
  expect_slides(
      {"coarser", {-20.0, 0.0, -20.0, 0.0}, {0.0, 20.0, -20.0, 0.0, 1e-3}, 8.0, up, 0.01});
}

/// Points of the side x = 0, right up to its upper edge, where they are as close to the top.
void add_edge(Shape& shape, double side) {
  for (double y = -0.0198; y < 0.02; y += 0.5e-3) {
    shape.add({0.0, y, -0.02e-3}, {side, 0.0, 0.0});
    shape.add({0.0, y, -0.04e-3}, {side, 0.0, 0.0});
  }
  shape.seal();
}

// With points at the very edges, and a hand that rubs: slips, and never sticks.
TEST(Union, RubsSmoothlyOverFlushSeam) {
  constexpr double kFriction = 0.3;
  Shape left = Block{-20.0, 0.0, -20.0, 0.0}.shape();
  Shape right = Block{0.0, 20.0, -20.0, 0.0, 0.5e-3, 2}.shape();
  add_edge(left, 1.0);
  add_edge(right, -1.0);
  for (const float rate_hz : {1000.0F, 4000.0F}) {
    for (const double speed : {0.02, 0.3}) {
      SCOPED_TRACE(testing::Message() << rate_hz << " Hz, " << speed << " m/s");
      Course course({{left}, {right}}, Isometry3d::Identity(), rate_hz);
      course.rig().configuration.contact.static_friction = static_cast<float>(kFriction);
      course.rig().configuration.contact.dynamic_friction = static_cast<float>(kFriction);
      course.start({-9.0, 0.7, 4.0});
      course.go({-9.0, 0.7, -2.0}, 0.1);
      course.go({-7.0, 0.7, -2.0}, speed);
      double furthest = 0.0;
      course.go({9.0, 0.7, -2.0}, speed, [&] {
        furthest = std::max(furthest, (course.force() - Vector3d(-kFriction, 0.0, 1.0)).norm());
      });
      EXPECT_LT(furthest, 0.01 + kWall * speed / static_cast<double>(rate_hz));
    }
  }
}

TEST(Union, HidesFacesWithinOtherBody) {
  expect_slides({"overlapping", {-20.0, 3.0, -20.0, 0.0}, {-4.0, 20.0, -20.0, 0.0}, 9.0, up, 0.01});
  expect_slides({"the same", {-20.0, 20.0, -20.0, 0.0}, {-20.0, 20.0, -20.0, 0.0}, 9.0, up, 0.01});
}

TEST(Union, StopsAtOtherBodyWalls) {
  expect_slides(
      {"flush on it", {-20.0, 20.0, -20.0, 0.0}, {0.0, 10.0, 0.0, 10.0}, 3.0, corner(0.0), 0.01});
  expect_slides(
      {"sunk in it", {-20.0, 20.0, -20.0, 0.0}, {0.0, 10.0, -5.0, 10.0}, 3.0, corner(0.0), 0.01});
  expect_slides(
      {"beside it", {-20.0, 0.0, -20.0, 0.0}, {0.0, 10.0, -20.0, 10.0}, 3.0, corner(0.0), 0.01});
}

// In the crease of two bodies, whose fits differ a little in every tick, a hand turns back.
TEST(Union, FollowsHandTurningInCrease) {
  std::mt19937_64 random(1);
  for (int turns = 0; turns < 6; ++turns) {
    const Eigen::Matrix3d turn = evaluation::any_turn(random);
    Prism plate{{{-0.02, -0.02}, {0.02, -0.02}, {0.02, 0.0}, {-0.02, 0.0}}, 0.02, turn};
    Prism wall{{{0.0, -0.005}, {0.01, -0.005}, {0.01, 0.01}, {0.0, 0.01}}, 0.02, turn};
    const Shape shapes[] = {sampled(plate, 0.5e-3, 0.3, 0.0, 1),
                            sampled(wall, 0.5e-3, 0.3, 0.0, 2)};
    for (const float rate_hz : {1000.0F, 4000.0F}) {
      SCOPED_TRACE(testing::Message() << rate_hz << " Hz, turn " << turns);
      SceneRig rig;
      rig.configuration.rate_hz = rate_hz;
      rig.add(shapes[0]);
      rig.add(shapes[1]);
      Vector3d at(-1e-3, -6e-3, 5e-3);
      double behind = 0.0;
      const auto go = [&](const Vector3d& to) {
        const Vector3d begin = at;
        const auto ticks = std::lround((to - begin).norm() / 0.1 * static_cast<double>(rate_hz));
        for (long i = 1; i <= ticks; ++i) {
          at = begin + static_cast<double>(i) / static_cast<double>(ticks) * (to - begin);
          rig.tick(turn * at);
          const Vector3d proxy = turn.transpose() * widen(rig.last.contact.proxy);
          behind = std::max(behind, std::abs(proxy.y() - at.y()));
        }
      };
      go({2e-3, -6e-3, -2e-3});
      go({2e-3, 6e-3, -2e-3});
      go({1e-3, -6e-3, -2e-3});
      EXPECT_LT(behind, 0.2e-3);
    }
  }
}

// Where the other body is lower, the proxy falls to it.
TEST(Union, FollowsStepDownOnce) {
  const Shape high = Block{-20.0, 0.0, -20.0, 0.0}.shape();
  for (const double step : {1.0, 3.0}) {
    const Shape low = Block{0.0, 20.0, -20.0, -step}.shape();
    for (const float rate_hz : {1000.0F, 4000.0F}) {
      SCOPED_TRACE(testing::Message() << step << " mm, " << rate_hz << " Hz");
      Course course({{high}, {low}}, Isometry3d::Identity(), rate_hz);
      course.start({-6.0, 0.7, 4.0});
      course.go({-6.0, 0.7, -4.0}, 0.1);
      int lost = 0;
      double furthest = 0.0;
      course.go({6.0, 0.7, -4.0}, 0.05, [&] {
        lost += course.feels() ? 0 : 1;
        const double x = course.hand().x();
        const double depth = 4.0 - (x > 0.0 ? step : 0.0);
        const double off = (course.force() - Vector3d(0.0, 0.0, 1e-3 * kWall * depth)).norm();
        furthest = x < 0.0 || x > 0.8 ? std::max(furthest, off) : furthest;
      });
      // Above 2 kHz candidates are gathered ahead of the fall.
      const double fall_s = (rate_hz > 2000.0F ? 1.3e-3 : 2.5e-3) * step;
      EXPECT_LE(static_cast<double>(lost) / static_cast<double>(rate_hz), fall_s)
          << "while it falls";
      EXPECT_LT(furthest, 0.03);
    }
  }
}

// Two balls whose crease is a circle: the proxy rests at the lowest place between them.
TEST(Union, HoldsCreaseOfRoundBodies) {
  const Shape ball = sphere(0.015, 0.5e-3);
  SceneRig rig;
  rig.add(ball, isometry({-0.009, 0.0, 0.0}));
  rig.add(ball, isometry({0.009, 0.0, 0.0}, {0.4, 0.9, 0.2}));
  rig.go({0.001, 0.0, 0.02});
  rig.go({0.001, 0.0, 0.009});
  const double z = std::sqrt(0.015 * 0.015 - 0.009 * 0.009);
  EXPECT_LT((widen(rig.last.contact.proxy) - Vector3d(0.0, 0.0, z)).norm(), 20e-6);
  EXPECT_LT((rig.force() - kWall * Vector3d(-0.001, 0.0, z - 0.009)).norm(), 0.01);
  double furthest = 0.0;
  for (double angle = 0.0; angle < 1.5; angle += 0.002) {  // around the crease, 30 mm/s
    rig.tick({0.001, 0.009 * std::sin(angle), 0.009 * std::cos(angle)});
    ASSERT_TRUE(rig.last.contact.in_contact);
    const Vector3d bottom(0.0, z * std::sin(angle), z * std::cos(angle));
    furthest = std::max(furthest, (widen(rig.last.contact.proxy) - bottom).norm());
  }
  EXPECT_LT(furthest, 60e-6);
}

// A wall that comes pushes the proxy along the floor, as far as it goes.
TEST(Union, PushesProxyWithMovingWall) {
  const Shape floor = Block{-20.0, 20.0, -20.0, 0.0}.shape();
  const Shape wall = Block{5.0, 15.0, 0.0, 15.0}.shape();
  for (const double speed : {0.01, 0.2}) {
    Course course({{floor}, {wall}}, Isometry3d::Identity(), 1000.0F);
    course.start({0.0, 0.7, 4.0});
    course.go({0.0, 0.7, -2.0}, 0.1);
    SceneRig& rig = course.rig();
    ASSERT_EQ(rig.scene.move(course.number(1), {}, {{static_cast<float>(-speed), 0.0F, 0.0F}, {}}),
              ModelStatus::kOk);
    double face = 5.0;
    for (; face > -6.0; face -= speed) {
      rig.rest(1);
      const Vector3d expected = 1e-3 * kWall * Vector3d(std::min(0.0, face), 0.0, 2.0);
      ASSERT_LT((course.force() - expected).norm(), 0.02 + 1e-3 * kWall * speed)
          << speed << ' ' << face << " proxy " << course.proxy().transpose();
    }
    // What pushes the hand is pushed back, each body by its share.
    Vector3d on_wall = Vector3d::Zero();
    for (const core::Reaction& reaction : rig.last.reactions) {
      on_wall = reaction.body == course.number(1) ? widen(reaction.force_N) : on_wall;
    }
    EXPECT_NEAR(on_wall.x(), -1e-3 * kWall * (face + speed), 0.01);
    EXPECT_NEAR(on_wall.z(), 0.0, 0.01);
  }
}

// Bodies that move together carry a proxy over their seam.
TEST(Union, HidesSeamOfMovingBodies) {
  const Shape left = Block{-20.0, 0.0, -20.0, 0.0}.shape();
  const Shape right = Block{0.0, 20.0, -20.0, 0.0}.shape();
  Course course({{left}, {right}}, Isometry3d::Identity(), 1000.0F);
  course.start({5.0, 0.7, 4.0});
  course.go({5.0, 0.7, -2.0}, 0.1);
  SceneRig& rig = course.rig();
  for (const std::size_t i : {0U, 1U}) {
    ASSERT_EQ(rig.scene.move(course.number(i), {}, {{0.1F, 0.0F, 0.02F}, {}}), ModelStatus::kOk);
  }
  for (int tick = 0; tick < 100; ++tick) {
    rig.rest(1);
    ASSERT_LT((course.force() - Vector3d(0.0, 0.0, kWall * (2e-3 + 2e-5 * tick))).norm(), 0.02)
        << tick;
  }
}

// The other body goes away while both hold the proxy.
TEST(Union, KeepsOtherBodyAfterRemoval) {
  const Shape floor = Block{-20.0, 20.0, -20.0, 0.0}.shape();
  const Shape wall = Block{0.0, 10.0, 0.0, 15.0}.shape();
  for (const std::size_t gone : {0U, 1U}) {
    Course course({{floor}, {wall}}, Isometry3d::Identity(), 1000.0F);
    course.start({-3.0, 0.7, 4.0});
    course.go({2.0, 0.7, -2.0}, 0.1);
    EXPECT_LT((course.force() - Vector3d(-1.0, 0.0, 1.0)).norm(), 0.02);
    SceneRig& rig = course.rig();
    ASSERT_EQ(rig.scene.remove(course.number(gone)), ModelStatus::kOk);
    Vector3d before = course.force();
    double largest = 0.0;
    for (int tick = 0; tick < 100; ++tick) {
      rig.rest(1);
      largest = std::max(largest, (course.force() - before).norm());
      before = course.force();
    }
    if (gone == 1U) {
      EXPECT_LT((course.force() - Vector3d(0.0, 0.0, 1.0)).norm(), 0.02);
    }
    EXPECT_LT(largest, 0.7) << gone;
  }
}

/// Signed distance from a cube about the origin, mm; negative inside.
double cube_distance(double half, const Vector3d& at) {
  const Vector3d beyond = at.cwiseAbs() - Vector3d::Constant(half);
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

// Two cubes in any place, and a hand on any path through them: it is held as long as it is in one
// of them, and the proxy is in neither; with fewer than one exception in 1 000 ticks.
TEST(Union, HoldsHandInEitherCube) {
  constexpr double kHalf = 8.0;  // mm
  const Shape cube = evaluation::box(1e-3 * kHalf, 0.3, 3);
  RandomPoses random(77);
  int in = 0;
  int lost = 0;
  int sunk = 0;
  double deepest = 0.0;
  for (int run = 0; run < 40; ++run) {
    const Isometry3d first = random.pose(0.005);
    const Isometry3d second = random.pose(0.009);
    Course course({{cube, first}, {cube, second}}, Isometry3d::Identity(), 1000.0F);
    const auto distance = [&](const Vector3d& at) {
      return std::min(cube_distance(kHalf, 1e3 * (first.inverse() * (1e-3 * at))),
                      cube_distance(kHalf, 1e3 * (second.inverse() * (1e-3 * at))));
    };
    course.start(40.0 * random.vector(1.0).normalized());
    for (int leg = 0; leg < 8; ++leg) {
      course.go(1e3 * random.vector(0.012), 0.08, [&] {
        const bool is_in = distance(course.hand()) < -0.1;
        in += is_in ? 1 : 0;
        lost += is_in && !course.feels() ? 1 : 0;
        const double depth = course.feels() ? -distance(course.proxy()) : 0.0;
        sunk += depth > 0.05 ? 1 : 0;
        deepest = std::max(deepest, depth);
      });
    }
  }
  EXPECT_GT(in, 10000);
  // A proxy that goes over an edge of one cube falls to the other one.
  EXPECT_LT(lost, in / 1000);
  EXPECT_LT(sunk, in / 1000);
  EXPECT_LT(deepest, 1.0);
}

}  // namespace
}  // namespace tactree::test
