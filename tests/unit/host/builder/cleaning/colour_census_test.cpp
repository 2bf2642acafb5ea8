// Messages about materials that no point has.

#include "cleaning/colour_census.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "warnings_of.hpp"

namespace tactree::builder {
namespace {

MaterialMap red_and_green() {
  MaterialMap map;
  map.base.stiffness_N_m = 100.0F;
  map.colours.push_back({"red", {255, 0, 0}, 30.0, map.base});
  map.colours.push_back({"green", {0, 255, 0}, 30.0, map.base});
  return map;
}

TEST(ColourCensus, CountsSimilarColoursTogether) {
  const MaterialMap map = red_and_green();
  ColourCensus census;
  EXPECT_TRUE(census.matches().empty());
  EXPECT_EQ(census.take({10, 20, 40}, map), 0);
  EXPECT_EQ(census.take({11, 22, 42}, map), 0);
  EXPECT_EQ(census.take({250, 0, 0}, map), 1);
  EXPECT_EQ(census.take({255, 255, 255}, map), 0);
  const std::vector<ColourCount> found = census.most_frequent(2);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].colour, (Colour{11, 21, 41}));
  EXPECT_EQ(found[0].points, 2U);
  EXPECT_EQ(found[1].points, 1U);
  EXPECT_EQ(census.most_frequent(9).size(), 3U);
}

TEST(ColourCensus, KeepsNearestColourOfEachMaterial) {
  const MaterialMap map = red_and_green();
  ColourCensus census;
  for (const Colour& colour : {Colour{250, 0, 0}, Colour{255, 0, 3}, Colour{0, 0, 0}}) {
    (void)census.take(colour, map);
  }
  ASSERT_EQ(census.matches().size(), 2U);
  EXPECT_EQ(census.matches()[0].points, 2U);
  EXPECT_EQ(census.matches()[0].nearest, (Colour{255, 0, 3}));
  EXPECT_DOUBLE_EQ(census.matches()[0].squared_distance, 9.0);
  EXPECT_EQ(census.matches()[1].points, 0U);
  EXPECT_DOUBLE_EQ(census.matches()[1].squared_distance, 65025.0);
}

TEST(ColourCensus, OmitsPointsOutsideCrop) {
  Scan scan;
  scan.positions = plane_grid(40, 1e-3).positions;
  double most = 0.0;
  for (const Eigen::Vector3d& position : scan.positions) {
    most = std::max(most, position.x());
  }
  for (const Eigen::Vector3d& position : scan.positions) {
    scan.colours.push_back(position.x() > most - 1e-4 ? Colour{0, 255, 0} : Colour{255, 0, 0});
  }
  BuildOptions options;
  options.materials = red_and_green();
  options.orient = OrientationRule::kUp;
  EXPECT_TRUE(warnings_of(scan, options).empty());
  options.crop =
      Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(most - 1e-4, 1, 1));
  const std::vector<std::string> warnings = warnings_of(scan, options);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0],
            "no point has the colour of the material 'green': the nearest to [0, 255, 0] is [255, "
            "0, 0], at a distance of 361 (raise its tolerance of 30, or give another rgb; the scan "
            "has [255, 0, 0] 1560 points)");
}

TEST(ColourCensus, ReportsMaterialOfDroppedPoints) {
  const ColourMaterial green = red_and_green().colours[1];
  EXPECT_EQ(unused_colour(green, {7, {0, 255, 0}, 0.0}, {})
                .find("no point of the model has the material 'green': the 7 points"),
            0U);
}

}  // namespace
}  // namespace tactree::builder
