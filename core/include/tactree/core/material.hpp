#pragma once
// What a contact feels like: the materials of the points around it, blended, so that the force does
// not step where one material ends and the next begins.
//
// Interrupt safety of all that follows: pure functions.

#include <cstdint>

#include "tactree/core/blob.hpp"
#include "tactree/core/configuration.hpp"
#include "tactree/core/proxy.hpp"
#include "tactree/core/surface.hpp"

namespace tactree::core {

/// The figures of a contact.
struct Feel {
  float stiffness_N_m = 0.0F;
  float damping_Ns_m = 0.0F;
  Friction friction{};
};

/// Materials that one blend can hold. Where still more meet within one support radius, the points
/// of those met last do not count.
inline constexpr std::uint32_t kBlendedMaterials = 8;

/// Which materials a contact is of, and in which shares; the shares add up to 1.
struct MaterialBlend {
  std::uint32_t count = 0;  ///< 0: of none, the configuration's figures hold
  std::uint32_t material[kBlendedMaterials] = {};
  float share[kBlendedMaterials] = {};
};

/// Does the configuration follow this model's own materials?
[[nodiscard]] constexpr bool follows_materials(const BlobView& view, const Configuration& c) {
  return c.use_materials && view.material_count() > 0U;  // memory: flash
}

/// The material of one point, or of none: precondition: point < point_count().
[[nodiscard]] MaterialBlend material_at(const BlobView& view, const Configuration& configuration,
                                        std::uint32_t point);

/// The materials around `x` on a surface with that normal, on the points' side: each candidate
/// counts with the weight it has in the surface fit and the cosine between the normals, so the
/// shares change without steps. Cost: one pass over the set, at most kMaxCandidates points, where
/// the model has more than one material; else constant.
void blend_materials(const BlobView& view, const Configuration& configuration,
                     const CandidateSet& set, Vec3 x, Vec3 normal, MaterialBlend& blend);

/// Cost: kBlendedMaterials.
[[nodiscard]] Feel feel_of(const BlobView& view, const Configuration& configuration,
                           const MaterialBlend& blend);

/// How far the texture lies below the surface at `x`, m: 0 .. 2 texture_height_m. A material's
/// texture is a field of bumps on the model, cut into the surface, so that contact begins on their
/// tops and nothing gets stiffer than the material:
///   depth = height (1 - nx^2 Y Z - ny^2 Z X - nz^2 X Y),  X = cos(2 pi x / wavelength), ...
/// A material without a height or wavelength has no texture; nor has a place further from the
/// model's origin than kTextureWaves wavelengths. No state: the same place is always as deep.
/// Cost: three cosines a material of the blend, about 100 operations each.
[[nodiscard]] float texture_depth(const BlobView& view, const MaterialBlend& blend, Vec3 x,
                                  Vec3 normal);

inline constexpr float kTextureWaves = 1048576.0F;  // 2^20: an eighth of a wave is still exact

inline constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFU;

/// The first material that is stiffer than material_limit(); kNoMaterial: none, or none is
/// followed.
[[nodiscard]] std::uint32_t find_unstable_material(const BlobView& view,
                                                   const Configuration& configuration);

/// Stiffest stable wall of a material's damping, N/m, with a hand: see stability_limit().
[[nodiscard]] float material_limit(const Configuration& configuration,
                                   const BlobMaterial& material);

}  // namespace tactree::core
