#pragma once
// Makes the windings of a mesh consistent and orients its faces outward.

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "geometry/mesh.hpp"
#include "tactree/builder/orientation.hpp"

namespace tactree::builder {

struct WindingRepair {
  std::uint64_t reversed_faces = 0;
  std::uint32_t shells = 0;            ///< sets of faces connected by edges of two faces
  std::uint32_t undecided_shells = 0;  ///< open sheets, oriented like most of their area
  double undecided_share = 0.0;        ///< ratio of the area
  bool watertight = false;             ///< all shells are closed
};

/// Vertices with equal coordinates count as one. Within a shell, faces that share an edge get the
/// same orientation. A closed shell gets a positive volume. A closed shell inside another keeps its
/// orientation relative to the other, or bounds a cavity if its faces contradict each other. An
/// open shell gets the orientation that `rule` states, or the one that is reached from outside; a
/// sheet keeps that of most of its area.
/// Deterministic. Cost: about 1 us per face, and 60 ms if a shell is open.
WindingRepair repair_windings(Mesh& mesh, OrientationRule rule,
                              std::span<const Eigen::Vector3d> viewpoints);

}  // namespace tactree::builder
