#include "sampling/mesh_sampling.hpp"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tactree/builder/length_text.hpp"

namespace tactree::builder {
namespace {

double to_unit(std::uint64_t bits) { return std::ldexp(static_cast<double>(bits >> 11), -53); }

// The area divided by the area per point, rounded up or down at random in proportion, so that faces
// smaller than the area of one point get the right number on average.
std::uint64_t count_on(double expected, std::size_t triangle) {
  const double whole = std::floor(expected);
  const bool one_more = to_unit(hash64(2 * triangle)) < expected - whole;
  return static_cast<std::uint64_t>(whole) + (one_more ? 1 : 0);
}

// The R2 sequence (Roberts): evenly spread in the unit square for any number of points.
Eigen::Vector2d spread_in_square(std::uint64_t i, std::uint64_t seed) {
  const double x = to_unit(seed) + 0.7548776662466927 * static_cast<double>(i);
  const double y = to_unit(hash64(seed)) + 0.5698402909980532 * static_cast<double>(i);
  return {x - std::floor(x), y - std::floor(y)};
}

/// The vertex with the maximum of the barycentric coordinates (1 - u - v, u, v).
std::uint32_t nearest_corner(const std::array<std::uint32_t, 3>& triangle,
                             const Eigen::Vector2d& at) {
  const double first = 1.0 - at.sum();
  if (first >= at.x() && first >= at.y()) {
    return triangle[0];
  }
  return at.x() >= at.y() ? triangle[1] : triangle[2];
}

/// Gives a sample the value of a vertex, if the mesh has such values.
template <class T>
void take_value(const std::vector<T>& of_vertices, std::uint32_t vertex, std::vector<T>& of_samples,
                std::uint64_t sample) {
  if (!of_vertices.empty()) {
    of_samples[sample] = of_vertices[vertex];
  }
}

}  // namespace

Cloud sample_faces(const Mesh& mesh, double spacing) {
  const double area_per_point = std::pow(kCandidateDistance * spacing, 2);
  const double wanted = area_of(mesh) / area_per_point;
  if (!(wanted <= kMaxCandidates)) {
    throw std::runtime_error(
        fmt::format("a spacing of {} on this surface needs {:.3g} sample points, more than {:.3g} "
                    "(raise --spacing to {:.2g} or more)",
                    length_text(spacing), wanted, kMaxCandidates,
                    spacing * std::sqrt(wanted / kMaxCandidates) * 1.01));
  }
  std::vector<std::uint64_t> first(mesh.triangles.size() + 1, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double area = 0.5 * corners_of(mesh, t).normal_times_twice_area().norm();
    first[t + 1] = first[t] + count_on(area / area_per_point, t);
  }
  Cloud cloud;
  cloud.positions.resize(first.back());
  cloud.normals.resize(first.back());
  cloud.materials.resize(mesh.materials.empty() ? 0 : first.back());
  cloud.colours.resize(mesh.colours.empty() ? 0 : first.back());
  cloud.doubtful.resize(mesh.doubtful.empty() ? 0 : first.back());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 64), [&](auto range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      const Corners c = corners_of(mesh, t);
      const Eigen::Vector3f normal = c.normal_times_twice_area().normalized().cast<float>();
      for (std::uint64_t i = first[t]; i < first[t + 1]; ++i) {
        Eigen::Vector2d at = spread_in_square(i - first[t], hash64(2 * t + 1));
        if (at.sum() > 1.0) {  // maps the other half of the square onto the triangle
          at = Eigen::Vector2d::Ones() - at;
        }
        cloud.positions[i] = c.a + at.x() * c.ab + at.y() * c.ac;
        cloud.normals[i] = normal;
        if (!mesh.doubtful.empty()) {
          cloud.doubtful[i] = mesh.doubtful[t];
        }
        const std::uint32_t corner = nearest_corner(mesh.triangles[t], at);
        take_value(mesh.materials, corner, cloud.materials, i);
        take_value(mesh.colours, corner, cloud.colours, i);
      }
    }
  });
  return cloud;
}

}  // namespace tactree::builder
