// Blending of materials by the weights of the surface fit, and the texture.
// Loop and memory annotations: docs/BOUND.md.
// memory: RAM

#include "tactree/core/contact/material.hpp"

namespace tactree::core {
namespace {

void set_single(MaterialBlend& blend, std::uint32_t material) {
  blend.count = 1;
  blend.material[0] = material;
  blend.share[0] = 1.0F;
}

void add(MaterialBlend& blend, std::uint32_t material, float weight) {
  std::uint32_t slot = 0;
  while (slot < blend.count && blend.material[slot] != material) {  // bound: kBlendedMaterials
    ++slot;
  }
  if (slot == kBlendedMaterials) {
    return;
  }
  if (slot == blend.count) {
    blend.material[slot] = material;
    blend.share[slot] = 0.0F;
    ++blend.count;
  }
  blend.share[slot] += weight;
}

/// Weight in the surface fit, times the cosine between the normals; 0 for the other side.
float weight_of(Vec3 offset, float inverse_squared, float cosine) {
  const float u = 1.0F - length_squared(offset) * inverse_squared;
  if (!(u > 0.0F) || !(cosine > 0.0F)) {
    return 0.0F;
  }
  const float u2 = u * u;
  return u2 * u2 * cosine;
}

/// cos(2 pi turns) for |turns| <= kTextureWaves; error below 1.3e-6. It is sin(2 pi u) with
/// |u| <= 1/4: a polynomial of degree 7 that agrees with it at four Chebyshev nodes of u^2.
[[gnu::always_inline]] inline float wave(float turns) {
  constexpr float kRound = 12582912.0F;  // 1.5 * 2^23: a sum with it has no fraction
  const float whole_turns = (turns + kRound) - kRound;
  const float u = 0.25F - absolute(turns - whole_turns);
  const float s = u * u;
  return u * (6.28318051F + s * (-41.3392461F + s * (81.4080069F + s * -71.6076801F)));
}

/// -1 .. 1 for a unit normal.
float bumps(Vec3 x, float wavelength, Vec3 n) {
  const Vec3 turns = (1.0F / wavelength) * x;
  const bool near = absolute(turns.x) <= kTextureWaves && absolute(turns.y) <= kTextureWaves &&
                    absolute(turns.z) <= kTextureWaves;
  if (!near) {
    return 1.0F;
  }
  const Vec3 w{wave(turns.x), wave(turns.y), wave(turns.z)};
  return n.x * n.x * w.y * w.z + n.y * n.y * w.z * w.x + n.z * n.z * w.x * w.y;
}

// Not inlined: texture_depth() calls it at two places.
[[gnu::noinline]] float depth_of(float height_m, float wavelength_m, Vec3 x, Vec3 normal) {
  if (!(height_m > 0.0F) || !(wavelength_m > 0.0F)) {
    return 0.0F;
  }
  const float level = 1.0F - bumps(x, wavelength_m, normal);
  return level > 0.0F ? height_m * level : 0.0F;
}

}  // namespace

MaterialBlend material_at(const BlobView& view, const Configuration& configuration,
                          std::uint32_t point) {
  MaterialBlend blend;
  if (follows_materials(view, configuration)) {
    set_single(blend, view.material_of(point));
  }
  return blend;
}

void blend_materials(const BlobView& view, const Configuration& configuration,
                     const CandidateSet& set, Vec3 x, Vec3 normal, MaterialBlend& blend) {
  blend.count = 0;
  if (!follows_materials(view, configuration)) {
    return;
  }
  if (view.material_count() == 1U) {
    set_single(blend, 0);
    return;
  }
  const float radius = view.support_radius_m();
  const float inverse_squared = 1.0F / (radius * radius);
  float sum = 0.0F;
  // bound: blended_points
  for (const Candidate& candidate : set) {
    const float weight =
        weight_of(candidate.position - x, inverse_squared, dot(candidate.normal, normal));
    if (weight > 0.0F) {
      add(blend, view.material_of(candidate.point), weight);
    }
  }
  for (std::uint32_t i = 0; i < blend.count; ++i) {  // bound: blended_materials
    sum += blend.share[i];
  }
  if (!(sum > 0.0F)) {
    set_single(blend, 0);
    return;
  }
  for (std::uint32_t i = 0; i < blend.count; ++i) {  // bound: blended_materials
    blend.share[i] /= sum;
  }
}

ContactParameters contact_parameters_of(const BlobView& view, const Configuration& c,
                                        const MaterialBlend& blend) {
  if (blend.count == 0U) {
    return c.contact;
  }
  ContactParameters blended{0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  for (std::uint32_t i = 0; i < blend.count; ++i) {  // bound: blended_materials
    const BlobMaterial& m = view.material(blend.material[i]);
    const float share = blend.share[i];
    blended.stiffness_N_m += share * m.stiffness_N_m;        // memory: flash
    blended.damping_Ns_m += share * m.damping_Ns_m;          // memory: flash
    blended.static_friction += share * m.static_friction;    // memory: flash
    blended.dynamic_friction += share * m.dynamic_friction;  // memory: flash
  }
  return blended;
}

float texture_depth(const BlobView& view, const Configuration& c, const MaterialBlend& blend,
                    Vec3 x, Vec3 normal) {
  if (blend.count == 0U) {
    return depth_of(c.contact.texture_height_m, c.contact.texture_wavelength_m, x, normal);
  }
  float depth = 0.0F;
  for (std::uint32_t i = 0; i < blend.count; ++i) {  // bound: blended_materials
    const BlobMaterial& m = view.material(blend.material[i]);
    const float height_m = m.texture_height_m;          // memory: flash
    const float wavelength_m = m.texture_wavelength_m;  // memory: flash
    depth += blend.share[i] * depth_of(height_m, wavelength_m, x, normal);
  }
  return depth;
}

std::uint32_t find_unstable_material(const BlobView& view, const Configuration& configuration) {
  if (!follows_materials(view, configuration)) {
    return kNoMaterial;
  }
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {  // bound: kMaxMaterials
    const BlobMaterial& material = view.material(i);
    if (!(material.stiffness_N_m <= material_limit(configuration, material))) {
      return i;
    }
  }
  return kNoMaterial;
}

float material_limit(const Configuration& configuration, const BlobMaterial& material) {
  Configuration with = configuration;
  with.contact.damping_Ns_m = material.damping_Ns_m;
  return stability_limit(with).with_hand_N_m;
}

}  // namespace tactree::core
