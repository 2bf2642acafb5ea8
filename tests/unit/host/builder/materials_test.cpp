// Materials of the points of a blob from the colours of a scan.

#include "tactree/builder/materials.hpp"

#include <gtest/gtest.h>

#include "shapes.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {
namespace {

constexpr Colour kRed = {255, 0, 0};
constexpr Colour kBlue = {0, 0, 255};

MaterialMap red_and_blue() {
  MaterialMap map;
  map.base.stiffness_N_m = 100.0F;
  map.colours.push_back({"red", kRed, 30.0, map.base});
  map.colours.push_back({"blue", kBlue, 30.0, map.base});
  map.colours[0].material.stiffness_N_m = 200.0F;
  map.colours[1].material.stiffness_N_m = 300.0F;
  return map;
}

BuildResult build(std::vector<Scan> scans, const BuildOptions& options) {
  Progress quiet;
  return build_model(std::move(scans), options, quiet);
}

/// The stiffness of each point of a blob.
template <typename Use>
void for_each_point(const BuildResult& result, Use&& use) {
  core::BlobView view;
  ASSERT_EQ(core::open_blob(result.blob.bytes, view), core::BlobStatus::kOk);
  for (core::LeafCursor cursor(view); !cursor.done(); cursor.next()) {
    const core::Leaf& leaf = cursor.leaf();
    for (std::uint32_t i = 0; i < leaf.point_count; ++i) {
      const std::uint32_t index = leaf.first_point + i;
      use(view.position(leaf, index), view.material(view.material_of(index)).stiffness_N_m);
    }
  }
}

TEST(MaterialMap, ChoosesNearestColourWithinTolerance) {
  MaterialMap map = red_and_blue();
  EXPECT_EQ(map.index_of({255, 0, 0}), 1);
  EXPECT_EQ(map.index_of({250, 10, 5}), 1);
  EXPECT_EQ(map.index_of({0, 0, 225}), 2);
  EXPECT_EQ(map.index_of({0, 0, 224}), 0);
  EXPECT_EQ(map.index_of({0, 255, 0}), 0);
  map.colours[0].tolerance = 442.0;
  map.colours[1].tolerance = 442.0;
  EXPECT_EQ(map.index_of({128, 0, 127}), 1);
  EXPECT_EQ(map.index_of({127, 0, 128}), 2);
  map.colours[0].tolerance = 0.0;
  EXPECT_EQ(map.index_of({255, 0, 0}), 1);
  EXPECT_EQ(map.index_of({254, 0, 0}), 2);
  ASSERT_EQ(map.list().size(), 3U);
  EXPECT_EQ(map.list()[2].stiffness_N_m, 300.0F);
}

TEST(MaterialMap, KeepsColoursThroughBuild) {
  Scan scan;
  Cloud cloud = random_sphere(60000, 0.05);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double x = cloud.positions[i].x();
    scan.colours.push_back(x < -0.02 ? kRed : x > 0.02 ? kBlue : Colour{9, 99, 9});
  }
  scan.positions = cloud.positions;
  scan.normals = cloud.normals;
  BuildOptions options;
  options.spacing_m = 2e-3;
  options.crop = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, 1, 1));
  options.centre = true;
  options.materials = red_and_blue();
  const BuildResult result = build({scan}, options);
  std::vector<std::uint64_t> counts(3, 0);
  for_each_point(result, [&](core::Vec3 p, float stiffness) {
    const float x = p.x;
    const float expected = x < -0.02F ? 200.0F : x > 0.02F ? 300.0F : 100.0F;
    if (std::abs(std::abs(x) - 0.02F) > 1e-5F) {
      EXPECT_EQ(stiffness, expected) << x;
    }
    ++counts[static_cast<std::size_t>(stiffness / 100.0F + 0.5F == 1.5F   ? 0
                                      : stiffness / 100.0F + 0.5F == 2.5F ? 1
                                                                          : 2)];
  });
  EXPECT_EQ(result.report.material_points, counts);
  EXPECT_GT(counts[1], 100U);
}

TEST(MaterialMap, TakesMaterialOfNearestCorner) {
  Scan scan;
  scan.positions = {{-0.05, -0.05, 0}, {0.05, -0.05, 0}, {0.05, 0.05, 0}, {-0.05, 0.05, 0}};
  scan.colours = {kRed, kBlue, kBlue, kRed};
  scan.triangles = {{0, 1, 2}, {0, 2, 3}};
  BuildOptions options;
  options.spacing_m = 1e-3;
  options.materials = red_and_blue();
  std::size_t wrong = 0;
  std::size_t points = 0;
  for_each_point(build({scan}, options), [&](core::Vec3 p, float stiffness) {
    // Within a fifth of the face from its left and right ends.
    if (std::abs(p.x) > 0.03F) {
      ++points;
      wrong += stiffness == (p.x < 0.0F ? 200.0F : 300.0F) ? 0 : 1;
    }
  });
  EXPECT_GT(points, 1000U);
  EXPECT_EQ(wrong, 0U);
}

TEST(MaterialMap, GivesColourlessScansBaseMaterial) {
  Scan coloured;
  coloured.positions = plane_grid(40, 1e-3).positions;
  coloured.colours.assign(coloured.positions.size(), kRed);
  Scan plain;
  plain.positions = plane_grid(40, 1e-3).positions;
  for (Eigen::Vector3d& p : plain.positions) {
    p.x() += 0.1;
  }
  BuildOptions options;
  options.materials = red_and_blue();
  for_each_point(build({coloured, plain}, options), [](core::Vec3 p, float stiffness) {
    EXPECT_EQ(stiffness, p.x > 0.07F ? 100.0F : 200.0F);
  });
}

TEST(MaterialMap, ReportsMissingAndUnusedColours) {
  Scan scan;
  scan.positions = plane_grid(40, 1e-3).positions;
  BuildOptions options;
  options.materials = red_and_blue();
  EXPECT_THROW((void)build({scan}, options), BuildError);
  scan.colours.assign(scan.positions.size(), kBlue);
  options.orient = OrientationRule::kUp;
  const BuildResult result = build({scan}, options);
  ASSERT_EQ(result.report.warnings.size(), 1U);
  EXPECT_NE(result.report.warnings[0].find("'red'"), std::string::npos);
}

TEST(MaterialMap, StoresSingleMaterialOnce) {
  Scan scan;
  scan.positions = plane_grid(40, 1e-3).positions;
  BuildOptions options;
  const std::uint64_t without = build({scan}, options).report.bytes;
  options.materials = MaterialMap{};
  options.materials->base.stiffness_N_m = 77.0F;
  const BuildResult result = build({scan}, options);
  EXPECT_EQ(result.report.bytes, without + sizeof(core::BlobMaterial));
  EXPECT_EQ(result.report.material_points, std::vector<std::uint64_t>{1600});
  for_each_point(result, [](core::Vec3, float stiffness) { EXPECT_EQ(stiffness, 77.0F); });
}

}  // namespace
}  // namespace tactree::builder
