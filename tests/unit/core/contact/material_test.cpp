// What a contact feels like: figures from the blob, their borders, and the texture.

#include "tactree/core/contact/material.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "analytic_shapes.hpp"
#include "scene_rig.hpp"
#include "tactree/core/control/controller.hpp"

namespace tactree::test {
namespace {

using core::BlobMaterial;
using core::Configuration;
using core::Vec3;

BlobMaterial smooth(float stiffness_N_m) {
  BlobMaterial material{};
  material.stiffness_N_m = stiffness_N_m;
  return material;
}

BlobMaterial textured(float height_m, float wavelength_m) {
  BlobMaterial material = smooth(1000.0F);
  material.texture_height_m = height_m;
  material.texture_wavelength_m = wavelength_m;
  return material;
}

Shape one_material(const BlobMaterial& material) {
  Shape shape;
  add_sheet(shape, 0.02, 0.0, 1.0);
  shape.model().materials = {material};
  shape.seal();
  return shape;
}

/// Moves down at x = from to the depth, then along x; records x and force of every tick.
struct Ride {
  std::vector<double> x;
  std::vector<Vec3> force;
};

Ride ride(const Shape& shape, double from, double to, double depth, double step,
          const Configuration& configuration = {}) {
  SceneRig rig(configuration);
  rig.add(shape);
  Ride result;
  for (double z = 1e-3; z > -depth; z -= 1e-4) {
    rig.scene.update(configuration, narrow({from, 0.0, z}), {});
  }
  for (double x = from; x <= to; x += step) {
    const core::Rendering r = rig.scene.update(configuration, narrow({x, 0.0, -depth}), {}).contact;
    EXPECT_TRUE(r.in_contact);
    result.x.push_back(static_cast<double>(r.proxy.x));
    result.force.push_back(r.force);
  }
  return result;
}

TEST(Material, AppliesStiffnessWithoutTexture) {
  const Shape shape = one_material(smooth(1234.0F));
  const Ride r = ride(shape, -0.005, 0.005, 1e-3, 1e-4);
  for (const Vec3& force : r.force) {
    EXPECT_NEAR(static_cast<double>(force.z), 1.234, 0.01);
  }
}

TEST(Material, FallsBackToConfiguration) {
  Configuration c;
  c.use_materials = false;
  EXPECT_NEAR(
      static_cast<double>(ride(one_material(smooth(1234.0F)), 0.0, 1e-3, 1e-3, 1e-4, c).force[0].z),
      0.5, 0.005);
  EXPECT_NEAR(static_cast<double>(ride(plane(), 0.0, 1e-3, 1e-3, 1e-4).force[0].z), 0.5, 0.005);
}

TEST(Material, BlendsForceAcrossBoundary) {
  const Shape shape = two_materials(smooth(200.0F), smooth(1000.0F));
  const double step = 1e-4;  // 0.1 m/s at 1 kHz
  const Ride r = ride(shape, -0.008, 0.008, 1e-3, step);
  EXPECT_NEAR(static_cast<double>(r.force.front().z), 0.2, 0.005);
  EXPECT_NEAR(static_cast<double>(r.force.back().z), 1.0, 0.01);
  double largest = 0.0;
  for (std::size_t i = 1; i < r.force.size(); ++i) {
    largest = std::max(largest, static_cast<double>(core::length(r.force[i] - r.force[i - 1])));
  }
  // 0.8 N over about two support radii of 2.5 mm; a step would be 0.8 N.
  EXPECT_LT(largest, 0.05);
  EXPECT_GT(largest, 0.8 * step / 5e-3);
}

TEST(Material, BlendsFrictionAcrossBoundary) {
  BlobMaterial left = smooth(500.0F);
  BlobMaterial right = smooth(500.0F);
  right.static_friction = 0.6F;
  right.dynamic_friction = 0.5F;
  const Ride r = ride(two_materials(left, right), -0.008, 0.012, 1e-3, 1e-4);
  const auto ratio = [&](std::size_t i) {
    return -static_cast<double>(r.force[i].x / r.force[i].z);
  };
  EXPECT_NEAR(ratio(5), 0.0, 0.01);
  EXPECT_NEAR(ratio(r.force.size() - 1), 0.5, 0.01);
  for (std::size_t i = 1; i < r.force.size(); ++i) {
    EXPECT_LT(static_cast<double>(core::length(r.force[i] - r.force[i - 1])), 0.06) << r.x[i];
  }
}

TEST(Material, IgnoresOtherSideOfPlate) {
  Shape shape;
  add_sheet(shape, 0.01, 0.25e-3, 1.0);
  add_sheet(shape, 0.01, -0.25e-3, -1.0);
  shape.model().materials = {smooth(100.0F), smooth(900.0F)};
  for (const Eigen::Vector3d& p : shape.model().positions) {
    shape.model().material_indices.push_back(p.z() > 0.0 ? 0 : 1);
  }
  shape.seal();
  core::CandidateSet set;
  for (const float up : {1.0F, -1.0F}) {
    const Vec3 x{0.0F, 0.0F, up * 0.25e-3F};
    set.clear();
    set.cover(shape.view(), x);
    core::MaterialBlend blend;
    core::blend_materials(shape.view(), {}, set, x, {0.0F, 0.0F, up}, blend);
    ASSERT_EQ(blend.count, 1U);
    EXPECT_EQ(blend.material[0], up > 0.0F ? 0U : 1U);
    EXPECT_NEAR(static_cast<double>(blend.share[0]), 1.0, 1e-6);
  }
}

TEST(Material, LimitsBlendSize) {
  Shape shape;
  add_sheet(shape, 0.01, 0.0, 1.0);
  for (std::uint8_t i = 0; i < 40; ++i) {
    shape.model().materials.push_back(smooth(100.0F + static_cast<float>(i)));
  }
  for (std::size_t i = 0; i < shape.model().positions.size(); ++i) {
    shape.model().material_indices.push_back(static_cast<std::uint8_t>(i % 40));
  }
  shape.seal();
  core::CandidateSet set;
  set.clear();
  set.cover(shape.view(), {});
  core::MaterialBlend blend;
  core::blend_materials(shape.view(), {}, set, {}, {0.0F, 0.0F, 1.0F}, blend);
  EXPECT_EQ(blend.count, core::kBlendedMaterials);
  const core::ContactParameters feel = core::contact_parameters_of(shape.view(), {}, blend);
  EXPECT_GE(feel.stiffness_N_m, 99.99F);
  EXPECT_LE(feel.stiffness_N_m, 140.01F);
}

TEST(Texture, HasConfiguredAmplitudeAndWavelength) {
  const double height = 0.1e-3;
  const double wavelength = 2e-3;
  const Shape shape =
      one_material(textured(static_cast<float>(height), static_cast<float>(wavelength)));
  const double depth = 1e-3;
  const double step = 1e-5;
  const Ride r = ride(shape, -0.006, 0.006, depth, step);
  std::vector<double> crests;
  double lowest = 1e9;
  double highest = -1e9;
  double largest_step = 0.0;
  for (std::size_t i = 1; i + 1 < r.force.size(); ++i) {
    const double z = static_cast<double>(r.force[i].z);
    lowest = std::min(lowest, z);
    highest = std::max(highest, z);
    largest_step = std::max(largest_step, std::abs(z - static_cast<double>(r.force[i - 1].z)));
    if (r.force[i].z >= r.force[i - 1].z && r.force[i].z > r.force[i + 1].z &&
        z > 1000.0 * (depth - 0.5 * height)) {
      crests.push_back(r.x[i]);
    }
  }
  // Crests at the smooth surface, valleys two heights below.
  EXPECT_NEAR(highest, 1000.0 * depth, 0.01);
  EXPECT_NEAR(highest - lowest, 1000.0 * 2.0 * height, 0.004);
  ASSERT_EQ(crests.size(), 5U);
  for (std::size_t i = 1; i < crests.size(); ++i) {
    EXPECT_NEAR(crests[i] - crests[i - 1], wavelength, 3.0 * step);
  }
  // No steeper than the cosine.
  EXPECT_LE(largest_step, 1000.0 * height * 2.0 * std::numbers::pi / wavelength * step * 1.1);
}

// The texture of a configuration is that of a material with the same values.
TEST(Texture, OfConfigurationAppliesWithoutMaterials) {
  Configuration c;
  c.contact.static_friction = c.contact.dynamic_friction = 0.0F;
  c.contact.damping_Ns_m = 0.0F;
  c.contact.stiffness_N_m = 1000.0F;
  const Ride smooth_ride = ride(plane(), -0.003, 0.003, 1e-3, 1e-4, c);
  c.contact.texture_height_m = 0.1e-3F;
  c.contact.texture_wavelength_m = 2e-3F;
  const Ride of_configuration = ride(plane(), -0.003, 0.003, 1e-3, 1e-4, c);
  Shape same = plane();
  same.model().materials = {textured(0.1e-3F, 2e-3F)};
  same.seal();
  const Ride of_material = ride(same, -0.003, 0.003, 1e-3, 1e-4);
  ASSERT_EQ(of_configuration.force.size(), of_material.force.size());
  double deepest = 0.0;
  for (std::size_t i = 0; i < of_material.force.size(); ++i) {
    EXPECT_EQ(of_configuration.force[i].z, of_material.force[i].z) << i;
    deepest =
        std::max(deepest, static_cast<double>(smooth_ride.force[i].z - of_material.force[i].z));
  }
  EXPECT_NEAR(deepest, 0.2, 0.01);
  // Materials take precedence.
  const Ride other = ride(one_material(smooth(1000.0F)), -0.003, 0.003, 1e-3, 1e-4, c);
  for (std::size_t i = 0; i < other.force.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(other.force[i].z), 1.0, 0.01) << i;
  }
}

TEST(Texture, NeverExceedsMaterialStiffness) {
  const Shape shape = one_material(textured(0.2e-3F, 3e-3F));
  for (double x = -1.5e-3; x <= 1.5e-3; x += 0.25e-3) {
    SceneRig rig{Configuration{}};
    rig.add(shape);
    double last = 0.0;
    for (double z = 1e-3; z > -1e-3; z -= 1e-5) {
      const core::Rendering r = rig.scene.update({}, narrow({x, 0.0, z}), {}).contact;
      const double force = static_cast<double>(r.force.z);
      ASSERT_GE(force, 0.0);
      ASSERT_LE(force - last, 1000.0 * 1e-5 * 1.01) << "x " << x << " z " << z;
      last = force;
    }
    EXPECT_GT(last, 0.5);
  }
}

TEST(Texture, IsBoundedContinuousAndStateless) {
  const Shape shape = one_material(textured(1e-3F, 2e-3F));
  const core::MaterialBlend blend = core::material_at(shape.view(), {}, 0);
  std::uint32_t seed = 1;
  const auto random = [&seed] {
    seed = seed * 1664525U + 1013904223U;
    return static_cast<float>(seed >> 8) / 16777216.0F * 2.0F - 1.0F;
  };
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x{0.1F * random(), 0.1F * random(), 0.1F * random()};
    const Vec3 n = core::normalized_or({random(), random(), random()}, {0.0F, 0.0F, 1.0F});
    const float depth = core::texture_depth(shape.view(), {}, blend, x, n);
    ASSERT_GE(depth, 0.0F);
    ASSERT_LE(depth, 2.001e-3F);
    ASSERT_EQ(depth, core::texture_depth(shape.view(), {}, blend, x, n));
    const Vec3 beside = x + Vec3{1e-6F * random(), 1e-6F * random(), 1e-6F * random()};
    ASSERT_NEAR(static_cast<double>(core::texture_depth(shape.view(), {}, blend, beside, n)),
                static_cast<double>(depth), 1e-3 * 2.0 * std::numbers::pi / 2e-3 * 3e-6);
  }
}

TEST(Texture, KeepsDepthFinite) {
  for (const float height : {0.0F, 1e-30F, 1.0F}) {
    for (const float wavelength : {0.0F, 1e-38F, 1e-6F, 1e3F}) {
      const Shape shape = one_material(textured(height, wavelength));
      const core::MaterialBlend blend = core::material_at(shape.view(), {}, 0);
      for (const float at : {0.0F, 1e-3F, 1.0F, -7.0F}) {
        const float depth =
            core::texture_depth(shape.view(), {}, blend, {at, -at, at}, {0.6F, 0.0F, 0.8F});
        EXPECT_TRUE(core::is_finite(depth));
        EXPECT_GE(depth, 0.0F);
        EXPECT_LE(depth, 2.0001F * height);
      }
    }
  }
}

TEST(Material, RefusesStiffnessAboveStabilityLimit) {
  Configuration c;
  BlobMaterial material = smooth(1.0F);
  const float limit = core::material_limit(c, material);
  EXPECT_NEAR(static_cast<double>(limit),
              static_cast<double>((c.device_damping_Ns_m + c.hand_damping_Ns_m) * 2.0F * c.rate_hz),
              1.0);
  for (const float share : {0.99F, 1.01F}) {
    material.stiffness_N_m = share * limit;
    const Shape shape = two_materials(smooth(1.0F), material);
    core::Controller controller;
    ASSERT_EQ(controller.configure(c), core::ConfigurationStatus::kOk);
    const bool stable = share < 1.0F;
    EXPECT_EQ(controller.load_model(shape.view()),
              stable ? core::ModelStatus::kOk : core::ModelStatus::kTooStiff);
    EXPECT_EQ(core::find_unstable_material(shape.view(), c), stable ? core::kNoMaterial : 1U);
  }
  EXPECT_STREQ(core::describe(core::ModelStatus::kTooStiff),
               "a material is stiffer than device, hand and rate allow");
}

TEST(Material, AccountsForDampingAndRate) {
  Configuration c;
  BlobMaterial material = smooth(2.0F * core::material_limit(c, smooth(1.0F)));
  EXPECT_NE(core::find_unstable_material(one_material(material).view(), c), core::kNoMaterial);
  material.damping_Ns_m = 2.0F * (c.device_damping_Ns_m + c.hand_damping_Ns_m);
  const Shape shape = one_material(material);
  EXPECT_EQ(core::find_unstable_material(shape.view(), c), core::kNoMaterial);
  core::Controller controller;
  ASSERT_EQ(controller.configure(c), core::ConfigurationStatus::kOk);
  ASSERT_EQ(controller.load_model(shape.view()), core::ModelStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kIdle);
  c.rate_hz = 500.0F;
  ASSERT_EQ(controller.configure(c), core::ConfigurationStatus::kOk);
  EXPECT_EQ(controller.state(), core::State::kNoModel);
  c.use_materials = false;
  ASSERT_EQ(controller.configure(c), core::ConfigurationStatus::kOk);
  EXPECT_EQ(controller.load_model(shape.view()), core::ModelStatus::kOk);
}

}  // namespace
}  // namespace tactree::test
