#include "tactree/simulation/hand_path.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "analytic_shapes.hpp"
#include "tactree/simulation/hand_script.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;

TEST(HandPath, NeedsFiniteWaypointsInOrder) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(HandPath({}), std::invalid_argument);
  EXPECT_THROW(HandPath({{nan, Eigen::Vector3d::Zero()}}), std::invalid_argument);
  EXPECT_THROW(HandPath({{0.0, Eigen::Vector3d(nan, 0.0, 0.0)}}), std::invalid_argument);
  EXPECT_THROW(HandPath({{1.0, Eigen::Vector3d::Zero()}, {1.0, Eigen::Vector3d::Zero()}}),
               std::invalid_argument);
}

TEST(HandScript, StartsAndEndsOutsideModel) {
  const Shape shape = evaluation::sphere();
  for (const std::string& name : simulation::script_names()) {
    const HandPath path = simulation::make_script(name, shape.view(), 4.0);
    EXPECT_GE(path.at(0.0).position_m.norm(), kSphereRadius + 0.005) << name;
    EXPECT_GE(path.at(4.0).position_m.norm(), kSphereRadius + 0.005) << name;
    double deepest = 1.0;
    for (double t = 0.0; t < 4.0; t += 1e-3) {
      deepest = std::min(deepest, path.at(t).position_m.norm() - kSphereRadius);
    }
    if (name == "hover") {
      EXPECT_GE(deepest, 0.005);
    } else {
      EXPECT_LE(deepest, -0.0005) << name;  // aims into the surface
      EXPECT_GE(deepest, -0.012) << name;
    }
  }
}

TEST(HandScript, ApproachesFromFacingSide) {
  Shape wall;  // faces -x
  for (int i = -10; i <= 10; ++i) {
    for (int k = -10; k <= 10; ++k) {
      wall.add({0.1, i * kSpacing, k * kSpacing}, {-1.0, 0.0, 0.0});
    }
  }
  wall.seal();
  const HandPath path = simulation::make_script("press", wall.view(), 4.0);
  EXPECT_LE(path.at(0.0).position_m.x(), 0.095);
  double furthest = 0.0;
  for (double t = 0.0; t < 4.0; t += 1e-2) {
    furthest = std::max(furthest, path.at(t).position_m.x());
  }
  EXPECT_GE(furthest, 0.104);
}

TEST(HandScript, RefusesInvalidNameOrModel) {
  EXPECT_THROW((void)simulation::make_script("dance", plane().view(), 1.0), std::invalid_argument);
  EXPECT_THROW((void)simulation::make_script("rub", core::BlobView{}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace tactree::test
