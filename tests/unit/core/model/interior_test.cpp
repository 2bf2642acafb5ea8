// Where a blob tells that there is material.

#include "tactree/core/model/interior.hpp"

#include <gtest/gtest.h>

#include <random>

#include "test_models.hpp"

namespace tactree {
namespace {

using core::Vec3;

TEST(Interior, DistinguishesInsideFromOutside) {
  constexpr float kRadius = 0.03F;
  builder::Model model = test::sphere(static_cast<double>(kRadius), 0.001);
  model.tells_interior = true;
  const test::TestBlob blob(model);
  ASSERT_NE(blob.view().interior(), nullptr);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-0.06F, 0.06F);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x{place(random), place(random), place(random)};
    const float height = length(x) - kRadius;
    if (core::absolute(height) > blob.view().reach_m()) {
      const bool here = core::interior_at(blob.view(), x).here;
      ASSERT_EQ(here, height < 0.0F) << x.x << " " << x.y << " " << x.z;
      inside += here ? 1 : 0;
    }
  }
  EXPECT_GT(inside, 500);
  for (const Vec3 point : blob.points()) {
    ASSERT_TRUE(core::interior_at(blob.view(), point).behind);
  }
}

TEST(Interior, IsUnknownWithoutSection) {
  const test::TestBlob blob(test::sphere(0.03, 0.001));
  EXPECT_EQ(blob.view().interior(), nullptr);
  EXPECT_FALSE(core::interior_at(blob.view(), {}).here);
  EXPECT_FALSE(core::interior_at(core::BlobView{}, {}).here);
}

TEST(Interior, ExcludesNonFinitePlaces) {
  builder::Model model = test::sphere(0.03, 0.001);
  model.tells_interior = true;
  const test::TestBlob blob(model);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(core::interior_at(blob.view(), {nan, 0.0F, 0.0F}).here);
  EXPECT_FALSE(core::interior_at(blob.view(), {1e30F, 0.0F, 0.0F}).here);
}

}  // namespace
}  // namespace tactree
