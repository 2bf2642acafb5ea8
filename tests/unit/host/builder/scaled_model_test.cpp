#include "tactree/builder/scaled_model.hpp"

#include <gtest/gtest.h>

#include "test_models.hpp"

namespace tactree::test {
namespace {

TEST(ScaledModel, KeepsPointsAtOtherSize) {
  builder::Model model = sphere(0.02, 0.001);
  model.tells_interior = true;
  const TestBlob blob(model);
  const builder::WrittenBlob larger = builder::scaled_model(blob.view(), 2.5);
  core::BlobView view;
  ASSERT_EQ(core::open_blob(larger.bytes, view), core::BlobStatus::kOk);
  ASSERT_EQ(view.point_count(), blob.view().point_count());
  const core::BlobHeader& before = blob.view().header();
  EXPECT_FLOAT_EQ(view.header().spacing_m, 2.5F * before.spacing_m);
  EXPECT_FLOAT_EQ(view.header().reach_m, 2.5F * before.reach_m);
  EXPECT_STREQ(view.header().name, before.name);
  EXPECT_NE(view.interior(), nullptr);
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint point = view.surface_point(leaf, index);
    ASSERT_NEAR(core::length(point.position), 0.05F, 2e-5F);
    ASSERT_GT(core::dot(point.position, point.normal), 0.0499F);
  });
}

}  // namespace
}  // namespace tactree::test
