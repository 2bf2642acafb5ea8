#pragma once
// Random point clouds of surfaces whose outward normals are known.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace tactree::bench {

/// Points on a surface and the true normal at each, which a build does not see.
struct KnownCloud {
  std::string name;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3d> normals;
};

/// Lengths are in spacings (square root of the area per point); features named "thin" have
/// the thickness `thin`. Each body has about `points` points, independent and uniform.
[[nodiscard]] KnownCloud twisted_arms(std::size_t points, double thin, std::uint64_t seed);
[[nodiscard]] KnownCloud long_blade(std::size_t points, double thin, std::uint64_t seed);
[[nodiscard]] KnownCloud thin_gear(std::size_t points, double thin, std::uint64_t seed);
[[nodiscard]] KnownCloud head_with_ears(std::size_t points, double thin, std::uint64_t seed);
[[nodiscard]] KnownCloud torus_knot(std::size_t points, double thin, std::uint64_t seed);
/// A solid ball with a hollow, and a ball in the hollow.
[[nodiscard]] KnownCloud nested_shells(std::size_t points, std::uint64_t seed);
/// A box whose height is `thin`.
[[nodiscard]] KnownCloud flat_plate(std::size_t points, double thin, std::uint64_t seed);
/// An open vessel with a wall of thickness `thin`.
[[nodiscard]] KnownCloud vessel(std::size_t points, double thin, std::uint64_t seed);
/// A figure that stands on a large hole: no points at its base.
[[nodiscard]] KnownCloud open_figure(std::size_t points, std::uint64_t seed);
/// A sheet with hills; its normals point along +z.
[[nodiscard]] KnownCloud open_relief(std::size_t points, std::uint64_t seed);

/// The part of a cloud that a camera at `viewpoint` sees: the nearest points along each ray.
[[nodiscard]] KnownCloud seen_from(const KnownCloud& cloud, const Eigen::Vector3d& viewpoint);
/// The union of what cameras all around see, each displaced by up to `registration` spacings.
[[nodiscard]] KnownCloud merged_views(const KnownCloud& cloud, int views, double registration,
                                      std::uint64_t seed);

/// Turns positions and normals by a random rotation; seed 0: none.
void rotate(KnownCloud& cloud, std::uint64_t seed);
/// Moves each point along its normal and across it by Gaussian noise, in spacings.
void add_noise(KnownCloud& cloud, double spacings, std::uint64_t seed);

}  // namespace tactree::bench
