#pragma once
// The integer lattice a model is quantised to, and the cubic root around it.

#include <Eigen/Core>
#include <cstdint>

#include "tactree/builder/model.hpp"
#include "tactree/core/vec3.hpp"

namespace tactree::builder {

struct Lattice {
  double step_m = 0.0;      ///< exactly a float32
  std::uint32_t depth = 0;  ///< levels below the root
  core::Int3 root_min{};    ///< lattice units
};

/// The lattice whose leaf edge is the smallest allowed one that is >= `leaf_edge_m` and keeps
/// step * integer exact in float32 over the root cube around [low, high].
/// Throws std::runtime_error when the extent is too large for that leaf edge.
[[nodiscard]] Lattice choose_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                     double leaf_edge_m);

/// The lattice whose root is, but for rounding, the smallest cube around [low, high].
/// Throws std::runtime_error when the model lies too far from the origin for that.
[[nodiscard]] Lattice bounding_lattice(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                       std::uint32_t depth);

}  // namespace tactree::builder
