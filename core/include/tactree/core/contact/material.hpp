#pragma once
// Contact parameters: the materials of the points around a contact, blended by weight, so that the
// force has no step at the boundary between two materials.
//
// Interrupt safety: pure functions.
// Loop and memory annotations: docs/BOUND.md.

#include <cstdint>

#include "tactree/core/configuration/configuration.hpp"
#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// Maximum number of materials in a blend. If a support radius contains more, the points of the
/// excess materials are ignored. The bound of a tick counts a texture for each material of a
/// blend; a support of 2.5 spacings holds about 20 points of a plane.
inline constexpr std::uint32_t kBlendedMaterials = 8;

/// The materials of a contact. The shares add up to 1.
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

/// Blends the materials around `x` on a surface with `normal`, which points to the side of the
/// points' normals. A candidate's weight is its weight in the surface fit times the cosine between
/// the normals, so that the blend changes continuously. Cost: one pass over the set, at most
/// kMaxCandidates points, if the model has more than one material; otherwise constant.
void blend_materials(const BlobView& view, const Configuration& configuration,
                     const CandidateSet& set, Vec3 x, Vec3 normal, MaterialBlend& blend);

/// The weighted mean of the materials' parameters. Cost: kBlendedMaterials.
[[nodiscard]] ContactParameters contact_parameters_of(const BlobView& view,
                                                      const Configuration& configuration,
                                                      const MaterialBlend& blend);

/// Depth of the texture below the surface at `x`, m: 0 .. 2 texture_height_m. A texture is a field
/// of bumps cut into the surface: contact begins at their tops, and no contact is stiffer than the
/// material.
///   depth = height (1 - nx^2 Y Z - ny^2 Z X - nz^2 X Y),  X = cos(2 pi x / wavelength), ...
/// The depth is 0 if the material has no height or no wavelength, and where a coordinate exceeds
/// kTextureWaves wavelengths. Without a blend, the texture is that of the configuration. Cost:
/// about 70 operations per material.
[[nodiscard]] float texture_depth(const BlobView& view, const Configuration& configuration,
                                  const MaterialBlend& blend, Vec3 x, Vec3 normal);

inline constexpr float kTextureWaves = 1048576.0F;  // 2^20: float32 still resolves 1/8 wavelength

inline constexpr std::uint32_t kNoMaterial = 0xFFFFFFFFU;

/// Index of the first material that is stiffer than material_limit(); kNoMaterial if there is none,
/// or if the configuration does not use materials.
[[nodiscard]] std::uint32_t find_unstable_material(const BlobView& view,
                                                   const Configuration& configuration);

/// Maximum stable stiffness with the material's damping and a hand on the device, N/m: see
/// stability_limit().
[[nodiscard]] float material_limit(const Configuration& configuration,
                                   const BlobMaterial& material);

}  // namespace tactree::core
