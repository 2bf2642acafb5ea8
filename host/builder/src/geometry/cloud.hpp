#pragma once
// A set of points with normals, materials and colours, as passed between the steps of a build.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tactree::builder {

using Box = Eigen::AlignedBox3d;

/// Direction to the scanner that saw a point.
struct Sight {
  Eigen::Vector3f toward = Eigen::Vector3f::Zero();  ///< unit vector to the scanner; 0: unknown
  bool sure = false;
};

struct Cloud {
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f>
      normals;  ///< empty, or one per position: unit length, or 0 if unknown
  std::vector<std::uint8_t> materials;   ///< empty, or one per position: index in the material map
  std::vector<std::uint8_t> doubtful{};  ///< empty, or one per position; 1: ambiguous orientation
  std::vector<Sight> sights{};           ///< empty, or one per position
  /// Empty, or one per position (R, G, B).
  std::vector<std::array<std::uint8_t, 3>> colours{};

  [[nodiscard]] std::size_t size() const { return positions.size(); }
  [[nodiscard]] bool has_normals() const { return !normals.empty(); }
  [[nodiscard]] bool has_materials() const { return !materials.empty(); }
  [[nodiscard]] bool has_sights() const { return !sights.empty(); }
  [[nodiscard]] bool has_colours() const { return !colours.empty(); }
};

[[nodiscard]] Box bounds_of(std::span<const Eigen::Vector3d> positions);

/// Longest edge of a box; 0 if it is empty.
[[nodiscard]] double largest_edge(const Box& box);

/// The points at `indices`, in that order.
[[nodiscard]] Cloud select(const Cloud& cloud, std::span<const std::uint32_t> indices);

/// Drops the points that are not at `indices`, which must ascend. Takes no memory.
void keep(Cloud& cloud, std::span<const std::uint32_t> indices);

/// Moves the points to the order of `order`, which holds each index once. Takes up to 16 bytes a
/// point.
void reorder(Cloud& cloud, std::span<const std::uint32_t> order);

/// Hash of a 64-bit number (the finaliser of splitmix64). The only source of randomness in a build.
[[nodiscard]] constexpr std::uint64_t hash64(std::uint64_t v) {
  v += 0x9E3779B97F4A7C15U;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9U;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBU;
  return v ^ (v >> 31);
}

}  // namespace tactree::builder
