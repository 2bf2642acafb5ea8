// Pictures of models: position of the shape, marks at the ends of the surface.

#include <gtest/gtest.h>

#include <cmath>

#include "tactree/picture/model_picture.hpp"
#include "test_models.hpp"

namespace tactree::test {
namespace {

using picture::Colour;
using picture::Raster;

constexpr Colour kWhite{1.0F, 1.0F, 1.0F};
constexpr Colour kBlack{};

TEST(RasterTest, NearerDiscsHideFartherOnes) {
  Raster raster(20, 20, kWhite);
  raster.disc(10.0F, 10.0F, 4.0F, 1.0F, kBlack);
  raster.disc(12.0F, 10.0F, 4.0F, 2.0F, {1.0F, 0.0F, 0.0F});
  EXPECT_EQ(raster.pixel(12, 10).red, 0.0F);
  EXPECT_EQ(raster.pixel(15, 10).red, 1.0F);
  EXPECT_EQ(raster.pixel(15, 10).green, 0.0F);
  EXPECT_EQ(raster.pixel(5, 10).green, 1.0F);
  EXPECT_EQ(raster.depth(12, 10), 1.0F);
}

TEST(RasterTest, ClipsToPicture) {
  Raster raster(8, 8, kWhite);
  for (const float x : {-1e9F, -3.0F, 0.0F, 7.5F, 30.0F, 1e9F}) {
    raster.disc(x, x, 3.0F, 0.0F, kBlack);
    raster.circle(x, 3.0F, 2.0F, 1.0F, kBlack);
  }
  raster.box(-5, -5, 100, 2, kBlack);
  raster.text(-3, 5, "abc 123?", 2, kBlack);
  EXPECT_EQ(raster.pixel(7, 1).red, 0.0F);
}

TEST(RasterTest, WritesPng) {
  const std::vector<std::byte> png = Raster(3, 2, kWhite).png();
  ASSERT_GT(png.size(), 24U);
  EXPECT_EQ(png[1], std::byte{'P'});
  EXPECT_EQ(png[19], std::byte{3});
  EXPECT_EQ(png[23], std::byte{2});
}

/// Share of the pixels that differ from the corner.
double drawn(const Raster& raster) {
  int count = 0;
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      count += raster.pixel(x, y).red != raster.pixel(0, 0).red ? 1 : 0;
    }
  }
  return static_cast<double>(count) / (raster.width() * raster.height());
}

int reds(const Raster& raster) {
  int count = 0;
  for (int y = 0; y < raster.height(); ++y) {
    for (int x = 0; x < raster.width(); ++x) {
      const Colour c = raster.pixel(x, y);
      count += c.red > 0.7F && c.green < 0.3F ? 1 : 0;
    }
  }
  return count;
}

TEST(ModelPicture, ShowsSphereAsTwoDiscs) {
  const TestBlob blob(sphere(0.05, 0.001));
  const Raster raster = picture::draw_model(blob.view(), {});
  // As high as there is room: all but two margins of 40 pixels and the caption's 70.
  const double radius = 0.5 * (720.0 - 2.0 * 40.0 - 70.0);
  EXPECT_NEAR(drawn(raster), 2.0 * 3.14159 * radius * radius / (1280.0 * 720.0), 0.01);
  EXPECT_EQ(reds(raster), 0);
}

TEST(ModelPicture, MarksHoleAtItsPosition) {
  const TestBlob blob(sphere(0.05, 0.001));
  const picture::Mark front{{0.04F, 0.02F, 0.02F}, 0.01F, true};
  EXPECT_GT(reds(picture::draw_model(blob.view(), std::span(&front, 1))), 100);
  // An open boundary is not as bad as a hole: another colour.
  const picture::Mark boundary{{0.04F, 0.02F, 0.02F}, 0.01F, false};
  EXPECT_EQ(reds(picture::draw_model(blob.view(), std::span(&boundary, 1))), 0);
}

}  // namespace
}  // namespace tactree::test
