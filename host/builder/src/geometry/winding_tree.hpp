#pragma once
// Sums the solid angles of many surface elements. A distant group of elements is approximated by
// one dipole (Barill, Dickson, Schmidt, Levin and Jacobson, "Fast winding numbers for soups and
// clouds", SIGGRAPH 2018).

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace tactree::builder {

/// A small patch of a surface.
struct SurfaceElement {
  Eigen::Vector3d centre;
  Eigen::Vector3d area;  ///< m^2, times the unit normal
};

class WindingTree {
 public:
  /// Preconditions: finite elements, at most 2^31. Deterministic. Cost: n log n; 90 bytes per
  /// element.
  explicit WindingTree(std::vector<SurfaceElement> elements);

  /// Sum of the solid angles, positive where the normals point away from `at`: 4 pi inside a body.
  /// An element counts at most 2 pi, and 0 at its own centre. Error: about 3 %. Cost: log n groups.
  [[nodiscard]] double angle(const Eigen::Vector3d& at) const;

 private:
  struct Node {
    SurfaceElement sum;  // the centre is weighted by area
    double radius = 0.0;
    std::uint32_t first = 0;  // elements_[first, last)
    std::uint32_t last = 0;
    std::uint32_t right = 0;  // the left child follows its parent; 0: no children
  };
  // Also sets the nodes below.
  void set_node(std::uint32_t index, std::uint32_t first, std::uint32_t last);

  std::vector<SurfaceElement> elements_;
  std::vector<Node> nodes_;
};

}  // namespace tactree::builder
