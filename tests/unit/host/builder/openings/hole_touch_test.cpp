// What a hand feels over the holes that a build lists, and over those that it does not.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapes.hpp"
#include "tactree/builder/build_model.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {
namespace {

constexpr double kPlateSpacing_m = 1e-3;

/// A plate of 30 x 30 mm at z = 0 with a round hole in its middle: a grid, or random points.
Scan plate_with_hole(double diameter_m, bool grid, std::uint64_t seed) {
  Scan scan;
  const std::size_t count = grid ? 900 : 5400;
  for (std::size_t k = 0; k < count; ++k) {
    const double u =
        grid ? static_cast<double>(k % 30) + unit_random(seed) : 30.0 * unit_random(seed + 2 * k);
    const double v = grid ? static_cast<double>(k / 30) + unit_random(seed + 1)
                          : 30.0 * unit_random(seed + 2 * k + 1);
    const Eigen::Vector3d p(1e-3 * (u - 15.0), 1e-3 * (v - 15.0), 0.0);
    if (p.norm() > 0.5 * diameter_m) {
      scan.positions.push_back(p);
      scan.normals.push_back(Eigen::Vector3f::UnitZ());
    }
  }
  return scan;
}

/// The least part of its force that a hand feels on its way over the hole, 0 where it falls
/// through.
float least_strength(const core::BlobView& view, double turn) {
  constexpr float kDepth_m = 5e-4F;
  const auto c = static_cast<float>(std::cos(turn));
  const auto s = static_cast<float>(std::sin(turn));
  const auto at = [&](float along, float z) { return core::Vec3{c * along, s * along, z}; };
  core::Proxy proxy;
  float along = -7e-3F;
  proxy.reset(at(along, 1e-3F));
  for (float z = 1e-3F; z > -kDepth_m; z -= 1e-4F) {
    proxy.update(view, at(along, z), {}, core::kWorkPerTick[0]);
  }
  float least = 1.0F;
  for (; along < 7e-3F; along += 5e-5F) {
    proxy.update(view, at(along, -kDepth_m), {}, core::kWorkPerTick[0]);
    least = std::min(least, proxy.in_contact() ? proxy.strength() : 0.0F);
  }
  return least;
}

TEST(HoleTouch, FullForceOverHolesThatAreNotListed) {
  int listed = 0;
  int not_listed = 0;
  for (double diameter = 2.0; diameter < 8.0; diameter += 0.25) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      Progress quiet;
      BuildOptions options;
      options.spacing_m = kPlateSpacing_m;
      options.unit_m = 1.0;
      const bool grid = seed % 2 == 0;
      const BuildResult model =
          build_model({plate_with_hole(1e-3 * diameter, grid, 1000 * seed)}, options, quiet);
      core::BlobView view;
      ASSERT_EQ(core::open_blob(model.blob.bytes, view), core::BlobStatus::kOk);
      float least = 1.0F;
      for (double turn = 0.1; turn < std::numbers::pi; turn += 0.5) {
        least = std::min(least, least_strength(view, turn));
      }
      const auto& openings = model.report.openings;
      const auto hole = std::find_if(openings.begin(), openings.end(), [](const Opening& o) {
        return o.kind == Opening::Kind::kHole;
      });
      const bool is_listed = hole != openings.end();
      (is_listed ? listed : not_listed) += 1;
      if (!is_listed) {
        EXPECT_EQ(least, 1.0F) << diameter << " mm, seed " << seed;
      } else if (hole->diameter_m > 6.0 * kPlateSpacing_m) {
        EXPECT_EQ(least, 0.0F) << diameter << " mm, seed " << seed;
      }
    }
  }
  EXPECT_GT(listed, 20);
  EXPECT_GT(not_listed, 20);
}

}  // namespace
}  // namespace tactree::builder
