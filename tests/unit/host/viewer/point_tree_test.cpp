// Points by level of detail: complete, without duplicates, coarse in the first node.

#include "tactree/viewer/point_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "test_models.hpp"

namespace tactree::test {
namespace {

using viewer::PointNode;
using viewer::PointTree;

Eigen::Vector3d place(const PointNode& node, const viewer::PackedPoint& point) {
  Eigen::Vector3d position;
  for (std::size_t i = 0; i < 3; ++i) {
    position[static_cast<Eigen::Index>(i)] =
        static_cast<double>(node.min_m[i]) + static_cast<double>(node.edge_m) * point[i] / 65535.0;
  }
  return position;
}

class PointTreeTest : public testing::Test {
 protected:
  TestBlob blob_{sphere(0.05, 0.00105)};
  PointTree tree_{blob_.view()};
};

TEST_F(PointTreeTest, HoldsEveryPointOnce) {
  ASSERT_GT(blob_.view().point_count(), 3 * viewer::kPointsPerNode);
  ASSERT_GT(tree_.nodes().size(), 8U);
  std::vector<Eigen::Vector3d> sent;
  for (std::size_t i = 0; i < tree_.nodes().size(); ++i) {
    EXPECT_LE(tree_.nodes()[i].point_count, viewer::kPointsPerNode);
    for (const viewer::PackedPoint& point : tree_.points(i)) {
      sent.push_back(place(tree_.nodes()[i], point));
    }
  }
  ASSERT_EQ(sent.size(), blob_.points().size());
  // Rounding is far below the spacing: a match in the cells around is the point itself.
  std::map<std::array<long, 3>, int> found;
  const auto key = [](const Eigen::Vector3d& p, int dx, int dy, int dz) {
    return std::array<long, 3>{std::lround(p.x() / 1e-4) + dx, std::lround(p.y() / 1e-4) + dy,
                               std::lround(p.z() / 1e-4) + dz};
  };
  for (const Eigen::Vector3d& p : sent) {
    ++found[key(p, 0, 0, 0)];
  }
  for (const core::Vec3 v : blob_.points()) {
    const Eigen::Vector3d p(static_cast<double>(v.x), static_cast<double>(v.y),
                            static_cast<double>(v.z));
    int near = 0;
    for (int i = 0; i < 27; ++i) {
      const auto at = found.find(key(p, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      near += at == found.end() ? 0 : at->second;
    }
    ASSERT_EQ(near, 1) << p.transpose();
  }
}

TEST_F(PointTreeTest, RootCoarselyCoversModel) {
  const PointNode& root = tree_.nodes()[0];
  EXPECT_GT(root.spacing_m, blob_.view().header().spacing_m);
  // Every place of the sphere has a point of the root within some of its spacings.
  for (std::size_t i = 0; i < blob_.points().size(); i += 23) {
    const core::Vec3 v = blob_.points()[i];
    const Eigen::Vector3d p(static_cast<double>(v.x), static_cast<double>(v.y),
                            static_cast<double>(v.z));
    const auto points = tree_.points(0);
    const bool near = std::any_of(points.begin(), points.end(), [&](const auto& point) {
      return (place(root, point) - p).norm() < 4.0 * static_cast<double>(root.spacing_m);
    });
    ASSERT_TRUE(near) << p.transpose();
  }
}

TEST_F(PointTreeTest, ChildrenLieInsideTheirParents) {
  for (std::size_t i = 0; i < tree_.nodes().size(); ++i) {
    const PointNode& node = tree_.nodes()[i];
    for (const std::uint32_t child : node.children) {
      ASSERT_GT(child, i);
      const PointNode& below = tree_.nodes()[child];
      EXPECT_FLOAT_EQ(below.edge_m, 0.5F * node.edge_m);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_GE(below.min_m[axis], node.min_m[axis]);
        EXPECT_LE(below.min_m[axis], node.min_m[axis] + 0.51F * node.edge_m);
      }
    }
  }
}

TEST_F(PointTreeTest, OctantsMatchBlob) {
  const viewer::OctantBoxes root = viewer::octant_boxes(blob_.view(), 0, 1000);
  EXPECT_EQ(root.corners_m.size(), 1U);
  const viewer::OctantBoxes leaves =
      viewer::octant_boxes(blob_.view(), blob_.view().depth(), 1000000);
  EXPECT_EQ(leaves.corners_m.size(), blob_.view().header().leaf_count);
  EXPECT_FLOAT_EQ(leaves.edge_m, blob_.view().header().leaf_edge_min_m);
  const viewer::OctantBoxes few = viewer::octant_boxes(blob_.view(), blob_.view().depth(), 500);
  EXPECT_LE(few.corners_m.size(), 500U);
  EXPECT_LT(few.level, blob_.view().depth());
}

/// A sphere whose points with positive x have the second of two materials.
builder::Model two_materials(double spacing_m) {
  builder::Model model = sphere(0.05, spacing_m);
  core::BlobMaterial material{};
  material.stiffness_N_m = 800.0F;
  model.materials = {material, material};
  model.materials[1].stiffness_N_m = 200.0F;
  for (const Eigen::Vector3d& position : model.positions) {
    model.material_indices.push_back(position.x() > 0.0 ? 1 : 0);
  }
  return model;
}

TEST_F(PointTreeTest, MaterialsBelongToTheirPoints) {
  const TestBlob blob(two_materials(0.00105));
  const PointTree tree(blob.view());
  std::size_t checked = 0;
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const auto points = tree.points(i);
    const auto materials = tree.materials(i);
    ASSERT_EQ(materials.size(), points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double x = place(tree.nodes()[i], points[k]).x();
      if (std::abs(x) > 1e-4) {  // not on the border
        ASSERT_EQ(materials[k], x > 0.0 ? 1 : 0) << x;
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 0.9 * blob.view().point_count());
  EXPECT_TRUE(tree_.materials(0).empty()) << "of a model without materials";
}

TEST_F(PointTreeTest, ColoursBelongToTheirPoints) {
  std::vector<viewer::Rgb> colours;
  for (const core::Vec3 point : blob_.points()) {
    colours.push_back(point.x > 0.0F ? viewer::Rgb{250, 10, 5} : viewer::Rgb{20, 30, 240});
  }
  const PointTree tree(blob_.view(), colours);
  EXPECT_TRUE(tree.has_colours());
  for (std::size_t i = 0; i < tree.nodes().size(); ++i) {
    const auto points = tree.points(i);
    ASSERT_EQ(tree.colours(i).size(), points.size());
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double x = place(tree.nodes()[i], points[k]).x();
      if (std::abs(x) > 1e-4) {  // not on the border
        ASSERT_EQ(tree.colours(i)[k][0], x > 0.0 ? 250 : 20) << x;
      }
    }
  }
  EXPECT_FALSE(tree_.has_colours());
  EXPECT_TRUE(tree_.colours(0).empty());
}

TEST(PointTreeJson, TellsMaterialsWithTheirLabels) {
  const TestBlob blob(two_materials(0.004));
  const PointTree tree(blob.view());
  const auto plain = nlohmann::json::parse(viewer::tree_json(tree, blob.view()))["materials"];
  ASSERT_EQ(plain.size(), 2U);
  EXPECT_EQ(plain[1]["stiffness_N_m"], 200.0);
  EXPECT_EQ(plain[0]["points"].get<std::uint32_t>() + plain[1]["points"].get<std::uint32_t>(),
            blob.view().point_count());
  EXPECT_FALSE(plain[1].contains("name"));
  const viewer::ScanFacts scan = {{{"default"}, {"felt", {{{250, 10, 5}}}}}, {{{9, 8, 7}, 1234}}};
  const auto told = nlohmann::json::parse(viewer::tree_json(tree, blob.view(), scan));
  EXPECT_EQ(told["colours"], nlohmann::json::parse(R"([{"rgb": [9, 8, 7], "points": 1234}])"));
  const auto& named = told["materials"];
  EXPECT_EQ(named[1]["name"], "felt");
  EXPECT_EQ(named[1]["rgb"], nlohmann::json({250, 10, 5}));
  EXPECT_FALSE(named[0].contains("rgb"));
}

}  // namespace
}  // namespace tactree::test
