#pragma once
// A set of points on its way through the pipeline.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

using Box = Eigen::AlignedBox3d;

struct Cloud {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f>
      normals;  ///< empty, or one per position: unit length, or 0 if unknown
  std::vector<std::uint8_t> materials;  ///< empty, or one per position: index in the material map

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool has_normals() const { return !normals.empty(); }
  [[nodiscard]] bool has_materials() const { return !materials.empty(); }
};

[[nodiscard]] Box bounds_of(std::span<const Eigen::Vector3d> positions);

/// The longest edge; 0 for an empty box.
[[nodiscard]] double largest_edge(const Box& box);

/// The points `order` names, in that order.
[[nodiscard]] Cloud select(const Cloud& cloud, std::span<const std::uint32_t> order);

/// A well-mixed 64-bit number from another (the finaliser of splitmix64): our only randomness.
[[nodiscard]] constexpr std::uint64_t hash64(std::uint64_t v) {
  v += 0x9E3779B97F4A7C15U;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9U;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBU;
  return v ^ (v >> 31);
}

}  // namespace tactree::builder
