// No crease lets a hand through: grooves, slots, corners of three and four faces, stairs of faces
// that are convex and concave; ridges are felt from the side on which the hand is.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include "tactree/builder/model.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::test {
namespace {

using namespace evaluation;  // NOLINT(google-build-using-namespace)
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSpring = 1000.0;  // N/m
constexpr double kH = 0.5e-3;       // spacing, m
constexpr core::Friction kNoFriction{0.0F, 0.0F};

/// A hand that is moved along a path in the frame of a body.
class Hand {
 public:
  Hand(const Shape& shape, const Matrix3d& turn, const Vector3d& start, float rate_hz,
       const core::Friction& friction = kNoFriction)
      : view_(shape.view()), turn_(turn), at_(start), rate_hz_(rate_hz), friction_(friction) {
    proxy_.reset(narrow(turn * start));
  }

  /// To `end` at a speed; calls each() after every tick.
  template <class Each>
  void move_to(const Vector3d& end, double speed, const Each& each) {
    const Vector3d begin = at_;
    const auto ticks =
        std::max(1L, std::lround((end - begin).norm() / speed * static_cast<double>(rate_hz_)));
    for (long i = 1; i <= ticks; ++i) {
      at_ = begin + (static_cast<double>(i) / double(ticks)) * (end - begin);
      tick();
      each();
    }
  }
  void move_to(const Vector3d& end, double speed) {
    move_to(end, speed, [] {});
  }
  void stay(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      tick();
    }
  }

  [[nodiscard]] const Vector3d& at() const { return at_; }
  [[nodiscard]] bool feels() const { return proxy_.in_contact(); }
  [[nodiscard]] Vector3d place() const { return turn_.transpose() * widen(proxy_.position()); }
  /// N, in the frame of the body.
  [[nodiscard]] Vector3d force() const {
    return feels() ? Vector3d(kSpring * static_cast<double>(proxy_.strength()) * (place() - at_))
                   : Vector3d::Zero();
  }
  [[nodiscard]] double largest_step() const { return largest_step_; }
  [[nodiscard]] const core::Proxy& proxy() const { return proxy_; }

 private:
  void tick() {
    const Vector3d last = force();
    const bool felt = feels();
    proxy_.update(view_, narrow(turn_ * at_), friction_, core::work_per_tick(rate_hz_));
    if (felt && feels()) {
      largest_step_ = std::max(largest_step_, (force() - last).norm());
    }
  }

  const core::BlobView& view_;
  Matrix3d turn_;
  Vector3d at_;
  float rate_hz_;
  core::Friction friction_;
  core::Proxy proxy_;
  double largest_step_ = 0.0;
};

std::vector<Matrix3d> turns(unsigned seed) {
  std::mt19937_64 random(seed);
  return {Matrix3d::Identity(), any_turn(random), any_turn(random)};
}

TEST(Crease, HoldsHandAtGrooveBottom) {
  for (const double angle : {20.0, 40.0, 60.0, 80.0, 100.0, 140.0}) {
    for (const Matrix3d& turn : turns(3)) {
      Prism prism = groove(angle);
      prism.turn = turn;
      const Shape shape = sampled(prism, kH, 0.3, 0.0, 7);
      for (const float rate : {1000.0F, 4000.0F}) {
        Hand hand(shape, turn, {0.4e-3, -8e-3, 6e-3}, rate);
        int lost = 0;
        const auto expect_contact = [&] { lost += hand.feels() ? 0 : 1; };
        hand.move_to({0.4e-3, -8e-3, -20e-6}, 0.02);
        hand.move_to({0.4e-3, -8e-3, -4e-3}, 0.02, expect_contact);
        hand.move_to({-0.6e-3, 8e-3, -4e-3}, 0.05, expect_contact);
        hand.stay(40);
        EXPECT_EQ(lost, 0) << angle << " degrees, " << rate << " Hz";
        const Vector3d place = hand.place();
        // An error of a face moves the bottom by more, the narrower the groove is.
        const double off = 1.5e-6 / std::sin(angle * std::numbers::pi / 360.0);
        EXPECT_LT(std::hypot(place.x(), place.z()), off) << angle << " degrees, " << rate;
        EXPECT_NEAR(hand.force().z(), 4.0, 0.02);
        // A tick of the hand is 0.05 N at most.
        EXPECT_LT(hand.largest_step(), 0.13) << angle << " degrees, " << rate;
      }
    }
  }
}

// Also in the tick in which the other face begins to hold. A push against the normal would be taken
// from the force.
TEST(Crease, PushesAlongNormal) {
  std::mt19937_64 random(9);
  for (const double angle : {40.0, 60.0, 90.0, 120.0}) {
    for (unsigned i = 0; i < 2; ++i) {
      Prism prism = groove(angle);
      prism.turn = any_turn(random);
      const Shape shape = sampled(prism, kH, 0.3, 0.0, i);
      Hand hand(shape, prism.turn, {3e-3, -4e-3, 9e-3}, 1000.0F);
      double least = 1.0;  // cosine
      const auto compare = [&] {
        const Vector3d push = hand.force();
        if (push.norm() > 0.5) {
          const Vector3d normal = prism.turn.transpose() * widen(hand.proxy().normal());
          least = std::min(least, normal.dot(push.normalized()));
        }
      };
      hand.move_to({3e-3, -4e-3, -1e-3}, 0.1, compare);
      hand.move_to({-2e-3, 4e-3, -3e-3}, 0.1, compare);
      hand.move_to({2e-3, -4e-3, -3e-3}, 0.1, compare);
      EXPECT_GT(least, 0.3) << angle << " degrees";
    }
  }
}

// The positions of the points and the codes of their normals are rounded differently in each turn.
TEST(Crease, HoldsHandAtGrooveBottomInAnyTurn) {
  std::mt19937_64 random(5);
  for (const double angle : {30.0, 60.0, 90.0, 120.0, 145.0, 150.0}) {
    double worst = 0.0;
    for (unsigned i = 0; i < 6; ++i) {
      Prism prism = groove(angle);
      prism.turn = any_turn(random);
      const Shape shape = sampled(prism, 2.0 * kH, 0.3, 0.0, i);
      Hand hand(shape, prism.turn, {0.2e-3, -4e-3, 6e-3}, 1000.0F);
      hand.move_to({0.2e-3, -4e-3, -4e-3}, 0.02);
      hand.stay(100);
      worst = std::max(worst, std::hypot(hand.place().x(), hand.place().z()));
    }
    EXPECT_LT(worst, 0.01 * (2.0 * kH)) << angle << " degrees";
  }
}

core::SurfaceFit smooth_fit(const Shape& shape, const Vector3d& x, const Vector3d& reference,
                            core::NearFaces& near) {
  core::CandidateSet points;
  points.clear();
  points.cover(shape.view(), narrow(x));
  return core::fit_surface(points, narrow(x), shape.view().support_radius_m(), narrow(reference),
                           1.0F, near);
}

// In a groove of 150 degrees, the mean of the two normals is so close to both that neither looks
// like that of another face.
TEST(Crease, FindsFaceIfReferenceIsBetweenTwo) {
  const Shape shape = sampled(groove(150.0), kH, 0.3, 0.0, 1);
  const Vector3d x(0.05e-3, 0.0, 0.1e-3);
  core::NearFaces none;
  const core::SurfaceFit between = smooth_fit(shape, x, Vector3d::UnitZ(), none);
  EXPECT_EQ(none.count, 0U);
  const Vector3d face = widen(between.next_reference);
  ASSERT_NEAR(angle_deg(face, Vector3d::UnitZ()), 15.0, 0.5);
  core::NearFaces other;
  EXPECT_EQ(smooth_fit(shape, x, face, other).next_reference, core::Vec3{});
  ASSERT_EQ(other.count, 1U);
  EXPECT_NEAR(angle_deg(widen(other.normal[0]), face), 30.0, 1.0);
}

TEST(Crease, DividesGrooveButNotRidgeByNearestPoint) {
  const Vector3d x(0.1e-3, 0.0, 0.05e-3);
  for (const bool is_groove : {true, false}) {
    const Shape shape = sampled(is_groove ? groove(120.0) : ridge(120.0), kH, 0.3, 0.0, 1);
    const double slope = is_groove ? -1.0 : 1.0;  // of the normal towards x, where x > 0
    const Vector3d face(slope * 0.5, 0.0, std::sqrt(0.75));
    core::NearFaces near;
    const core::SurfaceFit fit =
        smooth_fit(shape, x, (face + Vector3d(0.0, 0.1, 0.0)).normalized(), near);
    EXPECT_EQ(fit.next_reference, core::Vec3{});
    ASSERT_EQ(near.count, 1U);
    if (is_groove) {
      EXPECT_LT(angle_deg(widen(near.own), face), 0.5);
    } else {
      EXPECT_EQ(near.own, core::Vec3{});
    }
  }
}

TEST(Crease, HoldsHandBetweenSlotWalls) {
  for (const double width : {1e-3, 2e-3, 4e-3}) {
    for (const Matrix3d& turn : turns(4)) {
      Prism prism = slot(width);
      prism.turn = turn;
      const Shape shape = sampled(prism, kH, 0.3, 0.0, 8);
      Hand hand(shape, turn, {0.0, -8e-3, 3e-3}, 1000.0F);
      hand.move_to({0.0, -8e-3, -1e-3}, 0.02);
      int lost = 0;
      // Into the floor and one wall, then into the other one.
      hand.move_to({2.0 * width, 8e-3, -2e-3}, 0.05, [&] { lost += hand.feels() ? 0 : 1; });
      hand.stay(60);
      EXPECT_LT((hand.place() - Vector3d(0.5 * width, 8e-3, 0.0)).norm(), 30e-6) << width;
      hand.move_to({-2.0 * width, -8e-3, -2e-3}, 0.05, [&] { lost += hand.feels() ? 0 : 1; });
      hand.stay(60);
      EXPECT_LT((hand.place() - Vector3d(-0.5 * width, -8e-3, 0.0)).norm(), 30e-6) << width;
      EXPECT_EQ(lost, 0) << width;
    }
  }
}

TEST(Crease, HoldsHandInCorner) {
  constexpr double kHalf = 8e-3;
  for (const Matrix3d& turn : turns(5)) {
    const Shape shape = room(kHalf, kH, 0.3, 9, turn);
    for (const float rate : {1000.0F, 4000.0F}) {
      Hand hand(shape, turn, Vector3d::Zero(), rate);
      int lost = 0;
      hand.move_to(Vector3d::Constant(kHalf + 50e-6), 0.05);
      hand.move_to({kHalf + 2e-3, kHalf + 3e-3, kHalf + 1e-3}, 0.02,
                   [&] { lost += hand.feels() ? 0 : 1; });
      hand.stay(40);
      EXPECT_EQ(lost, 0) << rate;
      EXPECT_LT((hand.place() - Vector3d::Constant(kHalf)).norm(), 10e-6) << rate;
      EXPECT_LT((hand.force() - Vector3d(-2.0, -3.0, -1.0)).norm(), 0.02) << rate;
      // Along an edge to the next corner.
      hand.move_to({-kHalf - 2e-3, kHalf + 3e-3, kHalf + 1e-3}, 0.05,
                   [&] { lost += hand.feels() ? 0 : 1; });
      hand.stay(40);
      EXPECT_EQ(lost, 0) << rate;
      EXPECT_LT((hand.place() - Vector3d(-kHalf, kHalf, kHalf)).norm(), 10e-6) << rate;
      EXPECT_LT(hand.largest_step(), 0.15) << rate;
    }
  }
}

/// Two treads. The foot of the riser is at the origin, and the lower tread is at z = 0.
Prism stair(double rise) {
  constexpr double kRun = 6e-3;
  return {.profile = {
              {-kRun, -0.01}, {kRun, -0.01}, {kRun, rise}, {0.0, rise}, {0.0, 0.0}, {-kRun, 0.0}}};
}

// The treads have the same normal. The surface of both together would lie between them.
TEST(Crease, TouchesStairsExactly) {
  for (const double rise : {kH, 2.0 * kH}) {
    const double deep = 0.6 * rise;
    for (const Matrix3d& turn : turns(6)) {
      Prism prism = stair(rise);
      prism.turn = turn;
      const Shape shape = sampled(prism, kH, 0.3, 0.0, 10);
      for (const float rate : {1000.0F, 4000.0F}) {
        Hand hand(shape, turn, {3e-3, -4e-3, rise + 2e-3}, rate);
        int lost = 0;
        double off = 0.0;
        const auto expect_contact = [&] {
          lost += hand.feels() ? 0 : 1;
          off = std::max(off, std::abs(prism.distance(turn * hand.place())));
        };
        hand.move_to({3e-3, -4e-3, rise - deep}, 0.05);
        hand.move_to({0.2 * kH, -4e-3, rise - deep}, 0.05, expect_contact);
        hand.move_to({-3e-3, -2e-3, rise - 0.1 * kH}, 0.05);
        hand.move_to({-3e-3, -2e-3, -deep}, 0.05);
        hand.move_to({0.3 * deep, -2e-3, -deep}, 0.05, expect_contact);
        hand.stay(60);
        const Vector3d foot = hand.place();
        EXPECT_LT(std::hypot(foot.x(), foot.z()), 5e-6) << rise << " m, " << rate << " Hz";
        hand.move_to({0.3 * deep, 4e-3, -deep}, 0.05, expect_contact);
        EXPECT_EQ(lost, 0) << rise << " m, " << rate << " Hz";
        EXPECT_LT(off, 5e-6) << rise << " m, " << rate << " Hz";
      }
    }
  }
}

// The bound of a tick counts only the declared points.
TEST(Crease, ReportsMorePointsThanDeclared) {
  const Shape shape = sampled(groove(90.0), kH, 0.3, 0.0, 7);
  for (const bool is_sound : {true, false}) {
    std::vector<std::uint32_t> words(shape.bytes().size() / 4U);
    std::memcpy(words.data(), shape.bytes().data(), shape.bytes().size());
    if (!is_sound) {
      words[offsetof(core::BlobHeader, points_per_support_max) / 4U] = 5;
      builder::seal(std::as_writable_bytes(std::span(words)));
    }
    core::BlobView view;
    ASSERT_EQ(core::open_blob(std::as_bytes(std::span(words)), view), core::BlobStatus::kOk);
    core::Proxy proxy;
    proxy.reset(narrow({0.1e-3, 0.0, 3e-3}));
    for (double z = 3e-3; z > -1e-3; z -= 20e-6) {
      proxy.update(view, narrow({0.1e-3, 0.0, z}), kNoFriction, core::work_per_tick(1000.0F));
    }
    EXPECT_EQ(proxy.complete(), is_sound);
  }
}

TEST(Crease, KeepsFaceFrictionInGroove) {
  const Shape shape = sampled(groove(90.0), kH, 0.3, 0.0, 10);
  Hand hand(shape, Matrix3d::Identity(), {0.0, -8e-3, 3e-3}, 1000.0F, {0.4F, 0.3F});
  hand.move_to({0.0, -8e-3, -2e-3}, 0.02);
  hand.stay(20);
  const Vector3d rests = hand.place();
  EXPECT_LT(std::hypot(rests.x(), rests.z()), 5e-6);
  // Within the cone of static friction it sticks; beyond, it follows with that of dynamic friction.
  hand.move_to({0.0, -8e-3 + 0.7e-3, -2e-3}, 0.02);
  EXPECT_LT((hand.place() - rests).norm(), 5e-6);
  hand.move_to({0.0, 0.0, -2e-3}, 0.02);
  const Vector3d force = hand.force();
  EXPECT_NEAR(-force.y() / force.z(), 0.3, 0.01);
}

TEST(Crease, IgnoresFrictionOfFaceAhead) {
  const Shape shape = sampled(groove(60.0), kH, 0.3, 0.0, 13);
  Hand hand(shape, Matrix3d::Identity(), {1e-3, 0.0, 6e-3}, 1000.0F, {0.4F, 0.3F});
  hand.move_to({1e-3, 0.0, -4e-3}, 0.02);
  hand.stay(200);
  EXPECT_LT(std::hypot(hand.place().x(), hand.place().z()), 5e-6);
}

TEST(Crease, RendersNothingBesideRidge) {
  for (const double angle : {20.0, 30.0, 45.0, 60.0, 90.0}) {
    for (const Matrix3d& turn : turns(6)) {
      Prism prism = ridge(angle);
      prism.turn = turn;
      const Shape shape = sampled(prism, kH, 0.3, 0.0, 11);
      for (const double side : {-1.0, 1.0}) {
        // Down beside the ridge, 0.1 mm off its face.
        const double tan = std::tan(angle * std::numbers::pi / 360.0);
        const double off = 0.1e-3 / std::cos(angle * std::numbers::pi / 360.0);
        Hand hand(shape, turn, {side * off, 0.0, 5e-3}, 1000.0F);
        hand.move_to({side * off, 0.0, 0.0}, 0.02, [&] { EXPECT_FALSE(hand.feels()) << angle; });
        hand.move_to({side * (off + 3e-3 * tan), 0.0, -3e-3}, 0.02,
                     [&] { EXPECT_FALSE(hand.feels()) << angle; });
        // Into the face: it pushes back to the same side.
        hand.move_to({side * (off + 3e-3 * tan - 0.3e-3), 0.0, -3e-3}, 0.01);
        EXPECT_TRUE(hand.feels()) << angle;
        EXPECT_GT(side * hand.force().x(), 0.05) << angle;
        EXPECT_FALSE(hand.proxy().from_behind());
      }
    }
  }
}

// Beyond the top, the proxy moves on in the plane of the face until the force has faded. The few
// points that are left there are far away and determine no curvature.
TEST(Crease, FadesBeyondTopOfRidge) {
  std::mt19937_64 random(10);
  for (const double angle : {30.0, 45.0, 60.0}) {
    for (unsigned i = 0; i < 10; ++i) {
      Prism prism = ridge(angle);
      prism.turn = any_turn(random);
      const Shape shape = sampled(prism, kH, 0.3, 0.0, i);
      Hand hand(shape, prism.turn, {-0.1e-3, 0.0, 6e-3}, 4000.0F);
      hand.move_to({-0.1e-3, 0.0, -0.6e-3}, 0.1);
      hand.move_to({6e-3, 0.0, -0.6e-3}, 0.1);
      EXPECT_LT(hand.largest_step(), 0.35) << angle << " degrees, turn " << i;
    }
  }
}

// In one tick, a fast hand comes near an edge and behind the face beside it.
TEST(Crease, FeelsFastHandInFirstTickBehindFace) {
  std::mt19937_64 random(2);
  int late = 0;
  for (const double angle : {60.0, 90.0, 120.0}) {
    Prism prism = ridge(angle);
    prism.turn = any_turn(random);
    const Shape shape = sampled(prism, kH, 0.3, 0.0, 3);
    const double half = angle * std::numbers::pi / 360.0;
    const Vector3d along(std::sin(half), 0.0, -std::cos(half));
    const Vector3d out(std::cos(half), 0.0, std::sin(half));
    for (const double beside : {0.5e-3, 0.8e-3, 1.1e-3}) {
      for (const double depth : {0.05e-3, 0.2e-3, 0.35e-3, 0.5e-3}) {
        const Vector3d end = beside * along - depth * out;
        Hand hand(shape, prism.turn, end + 6e-3 * out, 1000.0F);
        hand.move_to(end + 1e-3 * out, 1.0);
        EXPECT_FALSE(hand.feels());
        hand.move_to(end, 1.0);
        late += hand.feels() ? 0 : 1;
      }
    }
  }
  EXPECT_EQ(late, 0);
}

// The hand slides off a block, 0.5 mm below its top, and is then in front of its side.
TEST(Crease, LetsHandSlideOffEdge) {
  std::mt19937_64 random(1);
  for (int turns = 0; turns < 12; ++turns) {
    Prism block;
    block.profile = {{-0.02, -0.02}, {0.0, -0.02}, {0.0, 0.0}, {-0.02, 0.0}};
    block.turn = any_turn(random);
    const Shape shape = sampled(block, 2.0 * kH, 0.3, 0.0, static_cast<unsigned>(turns));
    for (const float rate : {1000.0F, 2000.0F, 4000.0F}) {
      Hand hand(shape, block.turn, {-4e-3, -6e-3, 4e-3}, rate);
      hand.move_to({-4e-3, -6e-3, -0.5e-3}, 0.1);
      hand.move_to({-0.05e-3, -3e-3, -0.5e-3}, 0.1, [&] { EXPECT_TRUE(hand.feels()); });
      double held = 0.0;  // m, behind the edge
      hand.move_to({4e-3, 0.0, -0.5e-3}, 0.1,
                   [&] { held = hand.feels() ? std::max(held, hand.at().x()) : held; });
      EXPECT_LT(held, 0.15e-3) << rate << " Hz, turn " << turns;
    }
  }
}

// From near one wall to behind the other, whose points come near as those of the first one leave
// the support.
TEST(Crease, StopsHandThatCrossesGap) {
  std::mt19937_64 random(4);
  int crossings = 0;
  int missed = 0;
  for (const double angle : {20.0, 30.0, 40.0, 50.0}) {
    Prism prism = groove(angle);
    prism.turn = any_turn(random);
    const Shape shape = sampled(prism, kH, 0.3, 0.0, 5);
    const double half = angle * std::numbers::pi / 360.0;
    for (const double height : {2e-3, 3e-3, 4e-3, 6e-3}) {
      const double wall = height * std::tan(half);
      for (const double speed : {0.5, 1.0, 2.0}) {
        for (const double off : {-0.3e-3, 0.1e-3, 0.4e-3}) {  // of the first wall
          for (const double rise : {-1e-3, 0.0, 1e-3}) {
            for (const float rate : {1000.0F, 4000.0F}) {
              Hand hand(shape, prism.turn, {0.0, -2e-3, height}, rate);
              hand.move_to({off - wall, -1e-3, height}, 0.1);
              hand.stay(5);
              const double there = (height + rise) * std::tan(half) + 0.8e-3;
              hand.move_to({there, 0.0, height + rise}, speed);
              hand.stay(40);
              ++crossings;
              missed += hand.feels() && hand.force().x() < 0.0 ? 0 : 1;
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(missed, 0) << "of " << crossings;
}

TEST(Crease, AvoidsOscillationBelowRoundBend) {
  // A trough of 3 mm radius, with the hand 6 mm below its bottom.
  constexpr double kRadius = 3e-3;
  Shape shape(kH);
  for (double y = -8e-3; y < 8e-3; y += kH) {
    for (double turn = 0.0; turn <= std::numbers::pi; turn += kH / kRadius) {
      const Vector3d out(std::cos(turn), 0.0, -std::sin(turn));
      shape.add(kRadius * out + Vector3d(0.0, y, kRadius), -out);
    }
  }
  shape.seal();
  for (const float rate : {1000.0F, 4000.0F}) {
    Hand hand(shape, Matrix3d::Identity(), {0.2e-3, 0.0, 3e-3}, rate);
    hand.move_to({0.2e-3, 0.0, -6e-3}, 0.02);
    hand.move_to({0.2e-3, 2e-3, -6e-3}, 0.02);
    hand.stay(200);
    const Vector3d before = hand.force();
    hand.stay(1);
    EXPECT_LT((hand.force() - before).norm(), 0.02) << rate;
    EXPECT_LT(hand.largest_step(), 0.1) << rate;
  }
}

TEST(Crease, ProjectsOntoGrooveBottom) {
  for (const double angle : {30.0, 60.0, 90.0, 120.0}) {
    const Shape shape = sampled(groove(angle), kH, 0.3, 0.0, 12);
    const core::SurfaceProjection below =
        core::project_to_surface(shape.view(), {0.0F, 1e-3F, -0.5e-3F});
    ASSERT_TRUE(below.supported);
    EXPECT_LT((widen(below.point) - Vector3d(0.0, 1e-3, 0.0)).norm(), 5e-6) << angle;
    EXPECT_NEAR(static_cast<double>(below.signed_distance), -0.5e-3, 5e-6) << angle;
  }
}

}  // namespace
}  // namespace tactree::test
