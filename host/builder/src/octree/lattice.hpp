#pragma once
// The integer lattice for the positions of a model, and the root cube of the octree.

#include <Eigen/Core>
#include <cstdint>

#include "tactree/builder/model.hpp"
#include "tactree/core/math/vec3.hpp"

namespace tactree::builder {

struct Lattice {
  double step_m = 0.0;      ///< representable as float32
  std::uint32_t depth = 0;  ///< levels below the root
  core::Int3 root_min{};    ///< lattice units
};

/// The lattice with the smallest leaf edge >= `leaf_edge_m` for which step * integer is exact in
/// float32 over the root cube around [low, high]. Throws std::runtime_error if the extent is too
/// large for that leaf edge.
[[nodiscard]] Lattice choose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                     double leaf_edge_m);

/// The lattice whose root is the smallest cube around [low, high], up to rounding.
/// Throws std::runtime_error if the model lies too far from the origin for that.
[[nodiscard]] Lattice bounding_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                       std::uint32_t depth);

}  // namespace tactree::builder
