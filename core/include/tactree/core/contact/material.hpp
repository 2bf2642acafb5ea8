#pragma once
// Contact parameters: the materials of the points around a contact, blended by weight. The force
// does not step at the boundary between two materials.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/proxy.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// Parameters of a contact.
struct ContactParameters {
  float stiffness_N_m = 0.0F;
  float damping_Ns_m = 0.0F;
  Friction friction{};
};

/// Materials per blend. If more meet within one support radius, the points of the last ones are
/// ignored.
inline constexpr std::uint32_t kBlendedMaterials = 8;

/// The materials of a contact; their shares add up to 1.
struct MaterialBlend {
  std::uint32_t count = 0;  ///< 0: the configuration's parameters apply
  std::uint32_t material[kBlendedMaterials] = {};
  float share[kBlendedMaterials] = {};
};

/// True if the model has materials and the configuration uses them.
[[nodiscard]] constexpr bool follows_materials(const BlobView& view, const Configuration& c) {
  return c.use_materials && view.material_count() > 0U;  // memory: flash
}

/// The material of one point. Precondition: point < point_count().
[[nodiscard]] MaterialBlend material_at(const BlobView& view, const Configuration& configuration,
                                        std::uint32_t point);

/// The materials around `x` on a surface with that normal, on the points' side. A candidate's
/// weight is its weight in the surface fit times the cosine between the normals: the shares change
/// continuously. Cost: one pass over the set, at most kMaxCandidates points, if the model has more
/// than one material; else constant.
void blend_materials(const BlobView& view, const Configuration& configuration,
                     const CandidateSet& set, Vec3 x, Vec3 normal, MaterialBlend& blend);

/// The weighted mean of the materials' parameters. Cost: kBlendedMaterials.
[[nodiscard]] ContactParameters contact_parameters_of(const BlobView& view,
                                                      const Configuration& configuration,
                                                      const MaterialBlend& blend);

/// Depth of the texture below the surface at `x`, m: 0 .. 2 texture_height_m. A texture is a field
/// of bumps cut into the surface: contact begins on their tops, and no contact is stiffer than the
/// material.
///   depth = height (1 - nx^2 Y Z - ny^2 Z X - nz^2 X Y),  X = cos(2 pi x / wavelength), ...
/// No texture: a material without height or wavelength, and places further from the model's origin
/// than kTextureWaves wavelengths. Cost: three cosines per material, about 100 operations each.
[[nodiscard]] float texture_depth(const BlobView& view, const MaterialBlend& blend, Vec3 x,
                                  Vec3 normal);

inline constexpr float kTextureWaves = 1048576.0F;  // 2^20: an eighth of a wave is still exact

inline constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFU;

/// The first material that is stiffer than material_limit(); kNoMaterial: none, or the
/// configuration does not use materials.
[[nodiscard]] std::uint32_t find_unstable_material(const BlobView& view,
                                                   const Configuration& configuration);

/// Largest stable stiffness with the material's damping and a hand on the device, N/m: see
/// stability_limit().
[[nodiscard]] float material_limit(const Configuration& configuration,
                                   const BlobMaterial& material);

}  // namespace tactree::core
