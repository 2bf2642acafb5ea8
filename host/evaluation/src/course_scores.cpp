#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "edge_path.hpp"
#include "measurements.hpp"
#include "tactree/evaluation/creases.hpp"

namespace tactree::evaluation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Profile = std::vector<Vector2d>;  // of a Prism

constexpr double kFine = 0.5e-3;  // m, spacing of the points
constexpr double kBlock = 0.02;   // m, half the length and the height of a block
constexpr double kRun = 6e-3;     // m, depth of a stair
constexpr double kRoom = 0.01;    // m, half the width of a room and of a cube
constexpr double kAlong = 6e-3;   // m, slide along an edge to both sides of the centre
constexpr double kAbove = 6e-3;   // m, height above the surface at which a hand starts

struct Course {
  std::string name;
  bool rests = true;  // on a crease; otherwise nothing is off it
  /// Samples the bodies, turned.
  std::function<std::vector<Shape>(const Eigen::Matrix3d& turn, unsigned seed)> bodies;
  std::function<double(const Vector3d&)> distance;  // in the frame of the path
  std::function<double(const Vector3d&)> off;
  std::function<EdgePath(const Pace&)> path;
};

Profile block(double x_min, double x_max, double z_min, double z_max) {
  return {{x_min, z_min}, {x_max, z_min}, {x_max, z_max}, {x_min, z_max}};
}

/// The plane turned about y, so that its quarter x < 0, z > 0 opens upwards.
Profile turned_up(Profile profile) {
  const double half = std::sqrt(0.5);
  for (Vector2d& p : profile) {
    p = Vector2d(half * (p.x() + p.y()), half * (p.y() - p.x()));
  }
  return profile;
}

Course of_prisms(std::string name, const Profile& surface, std::vector<Profile> bodies,
                 double spacing_m) {
  Course course;
  course.name = std::move(name);
  course.bodies = [bodies = std::move(bodies), spacing_m](const Eigen::Matrix3d& turn,
                                                          unsigned seed) {
    std::vector<Shape> shapes;
    for (const Profile& profile : bodies) {
      shapes.push_back(sampled({.profile = profile, .turn = turn}, spacing_m, 0.3, 0.0, seed++));
    }
    return shapes;
  };
  course.distance = [prism = Prism{.profile = surface}](const Vector3d& p) {
    return prism.distance(p);
  };
  course.off = [](const Vector3d& p) { return std::hypot(p.x(), p.z()); };
  return course;
}

/// From the foot of the stair at the origin to the right, of which the lower one is at z = 0.
Profile stairs(double rise) {
  return {{-2.0 * kRun, -kBlock},
          {2.0 * kRun, -kBlock},
          {2.0 * kRun, 2.0 * rise},
          {kRun, 2.0 * rise},
          {kRun, rise},
          {0.0, rise},
          {0.0, 0.0},
          {-kRun, 0.0},
          {-kRun, -rise},
          {-2.0 * kRun, -rise}};
}

/// Slides on the upper stair and off its edge, presses into the foot of the riser, rests, slides
/// along the foot, up the riser, and away.
EdgePath down_stairs(double rise, const Pace& pace) {
  const double deep = std::min(2e-3, 0.7 * rise);
  EdgePath hand({0.5 * kRun, -kAlong, rise + kAbove}, pace);
  hand.move_to({0.5 * kRun, -kAlong, rise - 0.5e-3});
  hand.move_to({-0.5 * kRun, -0.5 * kAlong, rise - 0.5e-3});
  hand.move_to({-0.5 * kRun, -0.5 * kAlong, -deep});
  hand.move_to({0.5 * deep, -0.5 * kAlong, -deep});
  hand.stay();
  hand.move_to({0.5 * deep, kAlong, -deep});
  hand.move_to({0.3 * deep, 0.5 * kAlong, 0.8 * rise});
  hand.move_to({-0.5 * kRun, 0.0, kAbove});
  return hand;
}

/// Presses into the crease at the origin, which opens upwards, rests, slides along it and leaves.
EdgePath into_crease(const Pace& pace) {
  EdgePath hand({0.3e-3, -kAlong, kAbove}, pace);
  hand.move_to({0.3e-3, -kAlong, -3e-3});
  hand.stay();
  hand.move_to({0.3e-3, kAlong, -3e-3});
  hand.move_to({-1e-3, -kAlong, -2e-3});
  hand.move_to({0.0, -kAlong, kAbove});
  return hand;
}

/// Slides across a seam, rests on it, and slides along it.
EdgePath over_seam(const Pace& pace) {
  EdgePath hand({-8e-3, -kAlong, kAbove}, pace);
  hand.move_to({-8e-3, -kAlong, -2e-3});
  hand.move_to({8e-3, 0.0, -2e-3});
  hand.move_to({0.1e-3, kAlong, -2e-3});
  hand.stay();
  hand.move_to({-0.1e-3, -kAlong, -2e-3});
  hand.move_to({-8e-3, -kAlong, kAbove});
  return hand;
}

/// Presses against a wall, along it into an edge, along that into a corner, rests, and returns.
EdgePath into_corner(const Pace& pace) {
  const double beyond = kRoom + 2e-3;
  EdgePath hand({0.0, 0.2e-3, -0.3e-3}, pace);
  hand.move_to({beyond, 0.4e-3, 0.2e-3});
  hand.move_to({beyond, kRoom + 1.5e-3, 0.2e-3});
  hand.move_to({beyond, kRoom + 1.5e-3, kRoom + 1e-3});
  hand.stay();
  hand.move_to({beyond, 0.3 * kRoom, kRoom + 1e-3});
  hand.move_to({0.3 * kRoom, 0.0, kRoom + 1e-3});
  hand.move_to({0.0, 0.2e-3, -0.3e-3});
  return hand;
}

/// Slides over the top of a cube and across one of its corners, 0.5 mm deep.
EdgePath over_corner(const Pace& pace) {
  const double top = kRoom - 0.5e-3;
  EdgePath hand({0.0, 0.1e-3, kRoom + kAbove}, pace);
  hand.move_to({0.0, 0.1e-3, top});
  hand.move_to({kRoom - 0.5e-3, kRoom - 0.5e-3, top});
  hand.move_to({kRoom - 0.5e-3, 0.0, top});
  hand.move_to({kRoom + 3e-3, kRoom + 3e-3, top});
  return hand;
}

std::vector<Course> stair_courses() {
  std::vector<Course> courses;
  for (const double spacing : {kFine, 2.0 * kFine}) {
    for (const double rise : {1e-3, 2e-3, 3e-3, 5e-3}) {
      Course course =
          of_prisms(fmt::format("stairs of {} mm, h = {} mm", 1e3 * rise, 1e3 * spacing),
                    stairs(rise), {stairs(rise)}, spacing);
      course.path = [rise](const Pace& pace) { return down_stairs(rise, pace); };
      courses.push_back(std::move(course));
    }
  }
  return courses;
}

std::vector<Course> corner_courses() {
  std::vector<Course> courses;
  for (const double spacing : {kFine, 2.0 * kFine}) {
    Course course;
    course.name = fmt::format("room, h = {} mm", 1e3 * spacing);
    course.bodies = [spacing](const Eigen::Matrix3d& turn, unsigned seed) {
      std::vector<Shape> shapes;
      shapes.push_back(room(kRoom, spacing, 0.3, seed, turn));
      return shapes;
    };
    course.distance = [](const Vector3d& p) { return kRoom - p.cwiseAbs().maxCoeff(); };
    course.off = [](const Vector3d& p) { return (p - Vector3d::Constant(kRoom)).norm(); };
    course.path = into_corner;
    courses.push_back(std::move(course));
  }
  Course course = of_prisms("cube", block(-kRoom, kRoom, -kRoom, kRoom), {}, kFine);
  course.rests = false;
  course.bodies = [](const Eigen::Matrix3d& turn, unsigned seed) {
    std::vector<Shape> shapes;
    shapes.push_back(box(kRoom, 0.3, seed, kFine, turn));
    return shapes;
  };
  course.distance = [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() - kRoom; };
  course.path = over_corner;
  courses.push_back(std::move(course));
  return courses;
}

std::vector<Course> union_courses() {
  std::vector<Course> courses;
  const Profile top = block(-kBlock, kBlock, -kBlock, 0.0);
  const Profile left = block(-kBlock, 0.0, -kBlock, 0.0);
  const Profile right = block(0.0, kBlock, -kBlock, 0.0);
  const Profile over_right = block(-4e-3, kBlock, -kBlock, 0.0);
  for (const auto& [name, first, second] :
       {std::tuple{"two flush blocks", left, right},
        std::tuple{"two blocks that overlap", block(-kBlock, 3e-3, -kBlock, 0.0), over_right}}) {
    Course course = of_prisms(name, top, {first, second}, kFine);
    course.off = [](const Vector3d& p) { return std::abs(p.z()); };
    course.path = over_seam;
    courses.push_back(std::move(course));
  }
  const Profile corner = turned_up({{-kBlock, -kBlock},
                                    {kBlock, -kBlock},
                                    {kBlock, 0.0},
                                    {kRoom, 0.0},
                                    {kRoom, kRoom},
                                    {0.0, kRoom},
                                    {0.0, 0.0},
                                    {-kBlock, 0.0}});
  for (const double sunk : {0.0, 5e-3}) {
    Course course = of_prisms(sunk > 0.0 ? "block sunk in a plate" : "block on a plate", corner,
                              {turned_up(top), turned_up(block(0.0, kRoom, -sunk, kRoom))}, kFine);
    course.path = into_crease;
    courses.push_back(std::move(course));
  }
  constexpr double kRise = 3e-3;
  Course course = of_prisms("two blocks, a stair of 3 mm",
                            {{-kBlock, -kBlock},
                             {kBlock, -kBlock},
                             {kBlock, kRise},
                             {0.0, kRise},
                             {0.0, 0.0},
                             {-kBlock, 0.0}},
                            {left, block(0.0, kBlock, -kBlock, kRise)}, kFine);
  course.path = [](const Pace& pace) { return down_stairs(kRise, pace); };
  courses.push_back(std::move(course));
  return courses;
}

std::vector<CreaseResult> measure(const std::vector<Course>& courses, bool quick,
                                  std::uint32_t seed) {
  std::mt19937_64 random(seed);
  std::vector<CreaseResult> rows;
  for (const Course& course : courses) {
    CreaseResult row;
    row.name = course.name;
    row.rests = course.rests;
    for (unsigned turns = 0; turns < (quick ? 2U : 4U); ++turns) {
      EdgeScene around{{}, Eigen::Matrix3d::Identity(), course.distance, course.off};
      if (turns != 0) {
        around.turn = any_turn(random);
      }
      const std::vector<Shape> shapes = course.bodies(around.turn, seed + 2 * turns);
      for (const Shape& shape : shapes) {
        around.bodies.push_back(shape.view());
      }
      for (const Pace& pace : paces(quick)) {
        follow(course.path(pace), around, row);
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

void measure_courses(bool quick, std::uint32_t seed, Result& result) {
  result.stairs = measure(stair_courses(), quick, seed);
  result.corners = measure(corner_courses(), quick, seed);
  result.unions = measure(union_courses(), quick, seed);
}

}  // namespace tactree::evaluation
