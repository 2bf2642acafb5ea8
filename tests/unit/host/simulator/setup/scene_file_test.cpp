#include "tactree/setup/scene_file.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "folder_test.hpp"
#include "test_models.hpp"

namespace tactree::setup {
namespace {

class SceneFileTest : public test::FolderTest {
 protected:
  /// A scene of a sphere in a pose file's size.
  [[nodiscard]] SceneFile sphere_of_scale(const std::string& scale) const {
    const auto bytes = blob_.written().bytes;
    const std::string blob(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string pose =
        R"({"scale": )" + scale + R"(, "pose": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]})";
    return read_scene("", {write("sphere.blob", blob).string()}, write("pose.json", pose).string());
  }

  test::TestBlob blob_{test::sphere(0.02, 0.001)};
};

// The colours of a scan belong to the points of the blob that the user gave.
TEST_F(SceneFileTest, PointsInOtherSizeKnowTheirSource) {
  const SceneFile scene = sphere_of_scale("0.5");
  const core::BlobView& view = scene.files[0]->view();
  ASSERT_EQ(scene.sources.size(), 1U);
  ASSERT_EQ(scene.sources[0].size(), view.point_count());
  EXPECT_EQ(scene.given[0]->view().point_count(), blob_.view().point_count());
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::Vec3 source = blob_.points()[scene.sources[0][index]];
    ASSERT_LT(core::length(view.position(leaf, index) - 0.5F * source), 2e-5F);
  });
}

TEST_F(SceneFileTest, PointsInOwnSizeAreThoseOfTheBlob) {
  const SceneFile scene = sphere_of_scale("1");
  EXPECT_TRUE(scene.sources[0].empty());
  EXPECT_EQ(scene.files[0], scene.given[0]);
}

}  // namespace
}  // namespace tactree::setup
