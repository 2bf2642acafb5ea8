#include "tactree/simulation/hand_path.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "analytic_shapes.hpp"
#include "folder_test.hpp"
#include "message_of.hpp"
#include "tactree/simulation/hand_script.hpp"

namespace tactree::test {
namespace {

using simulation::HandPath;

class PathFile : public FolderTest {
 protected:
  HandPath read(const std::string& text) const {
    return simulation::read_hand_path(write("path.csv", text));
  }
  std::string refusal(const std::string& text) const {
    return message_of<std::runtime_error>([&] { read(text); })
        .substr((folder_ / "path.csv").string().size());
  }
};

TEST_F(PathFile, ReadsHeadingsAndComments) {
  const HandPath path =
      read("t_s,x,y,z\r\n# comment\n\n0, 0.1,0.2,0.3\r\n0.5,0.2,0.2,0.3\n1,0.2,0.4,-3e-1");
  ASSERT_EQ(path.waypoints().size(), 3U);
  EXPECT_EQ(path.waypoints()[2].position_m, Eigen::Vector3d(0.2, 0.4, -0.3));
  const plant::HandTarget target = path.at(0.25);
  EXPECT_NEAR(target.position_m.x(), 0.15, 1e-12);
  EXPECT_NEAR(target.velocity_m_s.x(), 0.2, 1e-12);
  EXPECT_EQ(path.at(-1.0).position_m.x(), 0.1);
  EXPECT_EQ(path.at(-1.0).velocity_m_s.norm(), 0.0);
  EXPECT_EQ(path.at(1.0).position_m.z(), -0.3);
  EXPECT_EQ(path.at(9.0).velocity_m_s.norm(), 0.0);
}

TEST_F(PathFile, ErrorsStatePlaceAndRemedy) {
  const std::string numbers =
      ": line 2: is not four numbers (write t_s,x,y,z in seconds and metres)";
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0\n"), numbers);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0,0,0\n"), numbers);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,nan,0\n"), numbers);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,inf,0\n"), numbers);
  EXPECT_EQ(refusal("0,0,0,0\n1,0,0x1,0\n"), numbers);
  EXPECT_EQ(refusal("0,0,0,0\n1,,0,0\n"), numbers);
  EXPECT_EQ(refusal("t_s,x,y,z\nt_s,x,y,z\n0,0,0,0\n"), numbers);
  for (const char* const names : {"t_s,z,y,x", "t_ms,x,y,z", "t_s,x_mm,y_mm,z_mm", "a,b"}) {
    EXPECT_EQ(refusal(std::string(names) + "\n0,0,0,0\n"),
              ": line 1: names other columns than t_s,x,y,z in seconds and metres (write these)");
  }
  EXPECT_EQ(read("t, x_m, y_m, z_m\n0,1,2,3\n").waypoints()[0].position_m.z(), 3.0);
  EXPECT_EQ(refusal("0,0,0,0\n0,0,0,0\n"),
            ": line 2: the time does not ascend (sort the rows by t_s)");
  EXPECT_EQ(refusal(""), ": has no waypoint (write rows t_s,x,y,z)");
  EXPECT_EQ(refusal("t_s,x,y,z\n"), ": has no waypoint (write rows t_s,x,y,z)");
  EXPECT_THROW((void)simulation::read_hand_path("/nonexistent/path.csv"), std::runtime_error);
}

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
