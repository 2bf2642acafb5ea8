#pragma once
// Clouds and meshes of analytic surfaces. Deterministic functions of their arguments.

#include <cmath>
#include <numbers>

#include "geometry/cloud.hpp"
#include "sampling/mesh_sampling.hpp"
#include "tactree/builder/scan.hpp"

namespace tactree::builder {

inline double unit_random(std::uint64_t i) {
  return std::ldexp(static_cast<double>(hash64(i) >> 11), -53);
}

/// n by n points on z = 0, a square grid.
inline Cloud plane_grid(int n, double spacing) {
  Cloud cloud;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      cloud.positions.emplace_back(spacing * i, spacing * j, 0.0);
    }
  }
  return cloud;
}

/// Independent uniform points on a sphere; with their outward normals.
inline Cloud random_sphere(std::size_t n, double radius, std::uint64_t seed = 1) {
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 2.0 * unit_random(seed * 0x10000000 + 2 * i) - 1.0;
    const double angle = 2.0 * std::numbers::pi * unit_random(seed * 0x10000000 + 2 * i + 1);
    const double ring = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d n3(ring * std::cos(angle), ring * std::sin(angle), z);
    cloud.positions.push_back(radius * n3);
    cloud.normals.push_back(n3.cast<float>());
  }
  return cloud;
}

/// The Fibonacci spiral: evenly spread points on a sphere; with their outward normals.
inline Cloud even_sphere(std::size_t n, double radius) {
  Cloud cloud;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < n; ++i) {
    const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(n);
    const double ring = std::sqrt(1.0 - z * z);
    const double angle = golden * static_cast<double>(i);
    const Eigen::Vector3d n3(ring * std::cos(angle), ring * std::sin(angle), z);
    cloud.positions.push_back(radius * n3);
    cloud.normals.push_back(n3.cast<float>());
  }
  return cloud;
}

/// z = height (cos kx + cos ky) over a square, n by n points shifted at random by up to 0.3 of
/// their spacing.
inline Cloud cosine_sheet(int n, double edge, double height, double k) {
  Cloud cloud;
  const double spacing = edge / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const auto seed = static_cast<std::uint64_t>(2 * (i * n + j));
      const double x = spacing * (i + 0.3 * unit_random(seed)) - 0.5 * edge;
      const double y = spacing * (j + 0.3 * unit_random(seed + 1)) - 0.5 * edge;
      cloud.positions.emplace_back(x, y, height * (std::cos(k * x) + std::cos(k * y)));
    }
  }
  return cloud;
}

/// A box between two corners, twelve triangles, counter-clockwise seen from outside.
inline Mesh box_mesh(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back((corner & 1) != 0 ? high.x() : low.x(),
                                (corner & 2) != 0 ? high.y() : low.y(),
                                (corner & 4) != 0 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The outward normal of the face of the box that a point lies on; zero at an edge or elsewhere.
inline Eigen::Vector3d box_face_at(const Eigen::Vector3d& p, const Eigen::Vector3d& low,
                                   const Eigen::Vector3d& high, double tolerance) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    normal[axis] += std::abs(p[axis] - high[axis]) < tolerance ? 1.0 : 0.0;
    normal[axis] -= std::abs(p[axis] - low[axis]) < tolerance ? 1.0 : 0.0;
  }
  return normal.norm() > 1.5 || normal.norm() < 0.5 ? Eigen::Vector3d::Zero().eval() : normal;
}

inline Cloud without_normals(Cloud cloud) {
  cloud.normals.clear();
  return cloud;
}

inline Scan cloud_scan(Cloud cloud) {
  Scan scan;
  scan.positions = std::move(cloud.positions);
  scan.normals = std::move(cloud.normals);
  return scan;
}

inline Scan mesh_scan(Mesh mesh) {
  Scan scan;
  scan.positions = std::move(mesh.positions);
  scan.triangles = std::move(mesh.triangles);
  return scan;
}

}  // namespace tactree::builder
