// Pictures of models: position of the shape, marks at the ends of the surface.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

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

TEST(ModelPicture, DrawsMarkUnlessHidden) {
  const TestBlob blob(sphere(0.05, 0.001));
  const auto marked = [&blob](std::array<float, 3> centre_m) {
    const picture::Mark mark{centre_m, 0.01F, true};
    const Raster with = picture::draw_model(blob.view(), std::span(&mark, 1));
    const picture::Mark other{centre_m, 0.01F, false};  // in another colour
    const Raster without = picture::draw_model(blob.view(), std::span(&other, 1));
    std::array<int, 2> changed{};
    for (int y = 100; y < with.height() - 100; ++y) {
      for (int x = 0; x < with.width(); ++x) {
        changed[x < with.width() / 2 ? 0 : 1] +=
            with.pixel(x, y).red != without.pixel(x, y).red ? 1 : 0;
      }
    }
    return changed;
  };
  EXPECT_GT(marked({0.04F, 0.02F, 0.02F})[0], 100);
  EXPECT_EQ(marked({0.04F, 0.02F, 0.02F})[1], 0);
  EXPECT_EQ(marked({-0.04F, -0.02F, 0.02F})[0], 0);
  EXPECT_GT(marked({-0.04F, -0.02F, 0.02F})[1], 100);
  // In the body, where no view sees it.
  EXPECT_GT(marked({0.0F, 0.0F, 0.0F})[0], 100);
  EXPECT_GT(marked({0.0F, 0.0F, 0.0F})[1], 100);
}

// Numbers lie in the margins beside the model, also of an opening as wide as it, and below the
// legend; only a thin line and a dot lie on the model.
TEST(ModelPicture, DrawsMarksBesideModel) {
  const TestBlob blob(sphere(0.05, 0.001));
  std::vector<picture::Mark> marks;
  for (int i = 0; i < 8; ++i) {
    marks.push_back({{0.03F, 0.03F, 0.028F}, 0.09F, true});
  }
  const Raster raster = picture::draw_model(blob.view(), marks);
  const auto is_red = [&](int x, int y) {
    const Colour c = raster.pixel(x, y);
    return c.red > 0.7F && c.green < 0.3F;
  };
  std::array<int, 2> count{};  // in the margin of the left view, on its model
  for (int y = 45; y < raster.height(); ++y) {
    for (int x = 0; x < 640; ++x) {
      const bool in_margin = x < 40 || x >= 600;
      count[in_margin ? 0 : 1] += is_red(x, y) ? 1 : 0;
    }
    EXPECT_FALSE(is_red(0, y) || is_red(639, y)) << y;  // none is cut
  }
  EXPECT_GT(count[0], 8 * 300);
  EXPECT_LT(count[1], 8 * 600);
  EXPECT_TRUE(is_red(45, 25));  // the key
  for (int x = 60; x < 1280; ++x) {
    EXPECT_FALSE(is_red(x, 25));
  }
}

TEST(ModelPicture, LegendLiesAboveModel) {
  builder::Model model = sphere(0.05, 0.001);
  model.materials.assign(6, core::BlobMaterial{});
  for (core::BlobMaterial& material : model.materials) {
    material.stiffness_N_m = 500.0F;
  }
  for (std::size_t i = 0; i < model.positions.size(); ++i) {
    model.material_indices.push_back(static_cast<std::uint8_t>(i % 5));
  }
  const TestBlob blob(model);
  std::vector<picture::MaterialKey> keys(6, {{0.9F, 0.1F, 0.1F}, "felt, 200 N/m"});
  const Raster raster = picture::draw_model(blob.view(), {}, {}, keys);
  const Colour paper = raster.pixel(0, 0);
  for (int x = 0; x < raster.width(); ++x) {
    EXPECT_EQ(raster.pixel(x, 20 + 4 * 22).red, paper.red);  // between the legend and the model
  }
  const auto has_key = [&](int x, int y) { return raster.pixel(x, y).red != paper.red; };
  EXPECT_TRUE(has_key(45, 45));
  EXPECT_TRUE(has_key(345, 25));   // the fifth
  EXPECT_FALSE(has_key(345, 47));  // no point has the sixth
}

TEST(RasterTest, DistinguishesNewtonFromLowerCase) {
  Raster newton(20, 20, kWhite);
  newton.text(2, 2, "N", 2, kBlack);
  Raster small(20, 20, kWhite);
  small.text(2, 2, "n", 2, kBlack);
  EXPECT_EQ(newton.pixel(2, 2).red, 0.0F);
  EXPECT_EQ(small.pixel(2, 2).red, 1.0F);
}

TEST(RasterTest, DrawsLines) {
  Raster raster(20, 20, kWhite);
  raster.line(2.0F, 3.0F, 16.0F, 10.0F, 1.5F, kBlack);
  EXPECT_EQ(raster.pixel(2, 3).red, 0.0F);
  EXPECT_EQ(raster.pixel(8, 6).red, 0.0F);
  EXPECT_EQ(raster.pixel(8, 10).red, 1.0F);
  EXPECT_EQ(raster.pixel(19, 12).red, 1.0F);
}

/// A sheet of 6 cm in the plane y = 0 whose outside is towards -y, or +y.
builder::Model upright_sheet(bool outside_at_negative_y) {
  builder::Model model = cos_sheet(0.03, 0.001, core::Profile::kSurface);
  const float sign = outside_at_negative_y ? -1.0F : 1.0F;
  for (std::size_t i = 0; i < model.positions.size(); ++i) {
    const Eigen::Vector3d p = model.positions[i];
    const Eigen::Vector3f n = model.normals[i];
    model.positions[i] = {p.x(), -p.z(), p.y()};
    model.normals[i] = sign * Eigen::Vector3f(n.x(), n.z(), n.y());
  }
  return model;
}

/// Pixels of the half of the picture that are warmer than grey, as the outside is, minus the colder
/// ones. The legend is not counted.
int warmth(const Raster& raster, int half) {
  int count = 0;
  for (int y = 100; y < raster.height() - 100; ++y) {
    for (int x = half * raster.width() / 2; x < (half + 1) * raster.width() / 2; ++x) {
      const Colour c = raster.pixel(x, y);
      count += c.red > c.blue + 0.03F ? 1 : c.blue > c.red + 0.03F ? -1 : 0;
    }
  }
  return count;
}

TEST(ModelPicture, ShowsOutsideOfSheetFirst) {
  for (const bool negative : {true, false}) {
    const TestBlob blob(upright_sheet(negative));
    const Raster raster = picture::draw_model(blob.view(), {});
    EXPECT_GT(warmth(raster, 0), 20000) << negative;
    EXPECT_LT(warmth(raster, 1), -20000) << negative;
  }
}

TEST(ModelPicture, ShowsOutsideFacingDown) {
  builder::Model model = cos_sheet(0.03, 0.001, core::Profile::kSurface);
  for (Eigen::Vector3f& normal : model.normals) {
    normal = -normal;
  }
  const TestBlob blob(model);
  EXPECT_GT(warmth(picture::draw_model(blob.view(), {}), 0), 10000);
}

TEST(ModelPicture, NamesSidesOnlyIfBothVisible) {
  const auto legend = [](const TestBlob& blob) {
    const Raster raster = picture::draw_model(blob.view(), {});
    // The second key, below that of the outside.
    return raster.pixel(45, 45).red != raster.pixel(0, 0).red;
  };
  EXPECT_TRUE(legend(TestBlob(upright_sheet(true))));
  EXPECT_FALSE(legend(TestBlob(sphere(0.05, 0.001))));
  EXPECT_FALSE(legend(TestBlob(cos_sheet(0.03, 0.001, core::Profile::kSurface))));
}

TEST(ModelPicture, ShowsMaterialsInTheirColours) {
  builder::Model model = sphere(0.05, 0.001);
  core::BlobMaterial material{};
  material.stiffness_N_m = 500.0F;
  model.materials = {material, material};
  for (const Eigen::Vector3d& position : model.positions) {
    model.material_indices.push_back(position.z() > 0.0 ? 1 : 0);
  }
  const TestBlob blob(model);
  const picture::MaterialKey keys[] = {{{0.2F, 0.3F, 0.9F}, "default"},
                                       {{0.9F, 0.1F, 0.1F}, "Felt"}};
  const Raster raster = picture::draw_model(blob.view(), {}, {}, keys);
  const int width = raster.width();
  const Colour top = raster.pixel(width / 4, raster.height() / 3);
  EXPECT_GT(top.red, 2.0F * top.blue);
  const Colour bottom = raster.pixel(width / 4, 2 * raster.height() / 3);
  EXPECT_GT(bottom.blue, 2.0F * bottom.red);
  // Its key is the second one.
  const Colour key = raster.pixel(45, 45);
  EXPECT_GT(key.red, 2.0F * key.blue);
  EXPECT_LT(reds(picture::draw_model(blob.view(), {})), 10);
}

TEST(ModelPicture, ShowsColoursOfScanWithoutMaterials) {
  const TestBlob blob(sphere(0.05, 0.001));
  std::vector<std::array<std::uint8_t, 3>> colours;
  for (const core::Vec3 point : blob.points()) {
    colours.push_back(point.z > 0.0F ? std::array<std::uint8_t, 3>{230, 25, 25}
                                     : std::array<std::uint8_t, 3>{50, 75, 230});
  }
  const Raster raster = picture::draw_model(blob.view(), {}, {}, {}, colours);
  const int width = raster.width();
  const Colour top = raster.pixel(width / 4, raster.height() / 3);
  EXPECT_GT(top.red, 2.0F * top.blue);
  const Colour bottom = raster.pixel(width / 4, 2 * raster.height() / 3);
  EXPECT_GT(bottom.blue, 2.0F * bottom.red);
}

}  // namespace
}  // namespace tactree::test
