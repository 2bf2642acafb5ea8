#include "geometry/cloud.hpp"

namespace tactree::builder {

Box bounds_of(std::span<const Eigen::Vector3d> positions) {
  Box box;
  for (const Eigen::Vector3d& p : positions) {
    box.extend(p);
  }
  return box;
}

double largest_edge(const Box& box) { return box.isEmpty() ? 0.0 : box.sizes().maxCoeff(); }

Cloud select(const Cloud& cloud, std::span<const std::uint32_t> order) {
  Cloud chosen;
  chosen.positions.reserve(order.size());
  chosen.normals.reserve(cloud.has_normals() ? order.size() : 0);
  chosen.materials.reserve(cloud.has_materials() ? order.size() : 0);
  chosen.doubtful.reserve(cloud.doubtful.empty() ? 0 : order.size());
  chosen.sights.reserve(cloud.has_sights() ? order.size() : 0);
  chosen.colours.reserve(cloud.has_colours() ? order.size() : 0);
  for (const std::uint32_t i : order) {
    chosen.positions.push_back(cloud.positions[i]);
    if (cloud.has_normals()) {
      chosen.normals.push_back(cloud.normals[i]);
    }
    if (cloud.has_materials()) {
      chosen.materials.push_back(cloud.materials[i]);
    }
    if (!cloud.doubtful.empty()) {
      chosen.doubtful.push_back(cloud.doubtful[i]);
    }
    if (cloud.has_sights()) {
      chosen.sights.push_back(cloud.sights[i]);
    }
    if (cloud.has_colours()) {
      chosen.colours.push_back(cloud.colours[i]);
    }
  }
  return chosen;
}

}  // namespace tactree::builder
