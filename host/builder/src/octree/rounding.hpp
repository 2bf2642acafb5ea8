#pragma once
// Rounds the points of a surface to sites of the lattice and their normals to codes. A site may be
// up to two sites from the position along the surface, and neighbouring codes compensate each
// other's errors: the surface through the points is more accurate than its points.

#include <Eigen/Core>
#include <cstdint>
#include <span>

namespace tactree::builder {

/// Maximum distance on each axis, in sites, of a position from the centre of its site.
inline constexpr double kSiteReach = 2.5;

/// The site, with 0 <= index <= last on each axis, whose centre is nearest to the plane through
/// `at` with this normal, among those within kSiteReach of `at`. Unit: sites; the centre of a site
/// is at its index + 0.5. If the normal is 0, the site that contains `at`.
[[nodiscard]] Eigen::Vector3i site_on_plane(const Eigen::Vector3d& at,
                                            const Eigen::Vector3d& normal, int last);

/// Writes the codes of unit normals. The error of a code is added to the normals of the points of
/// the same face that follow and are within `radius` (error diffusion), so that the mean of several
/// neighbouring codes is more accurate than one of them. `positions` have ascending z coordinates.
void encode_normals(std::span<const Eigen::Vector3d> positions,
                    std::span<const Eigen::Vector3f> normals, double radius,
                    std::span<std::uint32_t> codes);

}  // namespace tactree::builder
