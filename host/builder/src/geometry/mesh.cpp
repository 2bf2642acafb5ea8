#include "geometry/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace tactree::builder {
namespace {

// Edges shorter than this, relative to their coordinates, and flatter triangles are rounding
// errors.
constexpr double kFlat = 1e-14;

bool is_degenerate(const Corners& c) {
  const double longest =
      std::max({c.ab.squaredNorm(), c.ac.squaredNorm(), (c.ab - c.ac).squaredNorm()});
  return !(c.normal_times_twice_area().norm() > kFlat * longest) ||
         !(std::sqrt(longest) > kFlat * c.a.cwiseAbs().maxCoeff());
}

}  // namespace

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  const Eigen::Vector3d& a = mesh.positions[i];
  return {a, mesh.positions[j] - a, mesh.positions[k] - a};
}

std::array<std::uint64_t, 2> drop_faces(Mesh& mesh, const std::vector<bool>& keep) {
  std::array<std::uint64_t, 2> dropped = {0, 0};
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    if (!keep.empty() && !(keep[i] && keep[j] && keep[k])) {
      ++dropped[1];
    } else if (is_degenerate(corners_of(mesh, t))) {
      ++dropped[0];
    } else {
      mesh.triangles[kept++] = mesh.triangles[t];
    }
  }
  mesh.triangles.resize(kept);
  return dropped;
}

double area_of(const Mesh& mesh) {
  double twice = 0.0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    twice += corners_of(mesh, t).normal_times_twice_area().norm();
  }
  return 0.5 * twice;
}

}  // namespace tactree::builder
