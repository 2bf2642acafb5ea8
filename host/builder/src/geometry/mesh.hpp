#pragma once
// A triangle mesh, as passed between the steps of a build.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace tactree::builder {

struct Mesh {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into positions, all valid
  std::vector<std::uint8_t> materials;  ///< empty, or one per position, as in a Cloud
  std::vector<std::uint8_t> doubtful;   ///< empty, or one per triangle; 1: ambiguous orientation
  /// Empty, or one per position (R, G, B).
  std::vector<std::array<std::uint8_t, 3>> colours{};
};

struct Corners {
  Eigen::Vector3d a;
  Eigen::Vector3d ab;
  Eigen::Vector3d ac;

  [[nodiscard]] Eigen::Vector3d normal_times_twice_area() const { return ab.cross(ac); }
};

[[nodiscard]] Corners corners_of(const Mesh& mesh, std::size_t triangle);

/// Drops triangles whose area is within the rounding of their coordinates, and triangles with a
/// vertex for which `keep` is false (empty: keep all). Returns the counts {degenerate, with a
/// dropped vertex}.
std::array<std::uint64_t, 2> drop_faces(Mesh& mesh, const std::vector<bool>& keep);

[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace tactree::builder
