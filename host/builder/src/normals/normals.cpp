#include "normals/normals.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/local_points.hpp"

namespace tactree::builder {
namespace {

constexpr double kFitSpacings = 1.5;
constexpr std::size_t kLeastFitted = 12;
constexpr std::size_t kMaxFitted = 96;

// Normal of the plane through the neighbours of `centre`. Nearer neighbours have more weight.
Eigen::Vector3f fit_normal(const ZOrderedCloud& dense, const Eigen::Vector3d& centre,
                           const std::vector<Neighbour>& neighbours) {
  double farthest = 0.0;
  for (const Neighbour& n : neighbours) {
    farthest = std::max(farthest, n.squared_distance);
  }
  const double per_squared_radius = 1.0 / (1.2 * farthest + 1e-300);
  double weight_sum = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : neighbours) {
    const double weight = 1.0 - n.squared_distance * per_squared_radius;
    const Eigen::Vector3d d = dense.positions()[n.index] - centre;
    const Eigen::Vector3d weighted = weight * d;
    weight_sum += weight;
    mean += weighted;
    covariance += weighted * d.transpose();
  }
  covariance -= mean * mean.transpose() / weight_sum;
  covariance /= std::max(covariance.trace(), 1e-300);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  return normal.allFinite() && normal.norm() > 0.5F ? Eigen::Vector3f(normal.normalized())
                                                    : Eigen::Vector3f::UnitZ();
}

}  // namespace

std::vector<Eigen::Vector3f> estimate_normals(const ZOrderedCloud& points,
                                              const ZOrderedCloud& dense, double spacing,
                                              double dense_spacing) {
  const double in_radius =
      std::numbers::pi * std::pow(kFitSpacings * spacing / std::max(dense_spacing, 1e-300), 2);
  const auto fitted = static_cast<std::size_t>(
      std::clamp(in_radius, static_cast<double>(kLeastFitted), static_cast<double>(kMaxFitted)));
  const double guess =
      1.3 * dense_spacing * std::sqrt(static_cast<double>(fitted) / std::numbers::pi);
  std::vector<Eigen::Vector3f> normals = points.normals();
  normals.resize(points.size(), Eigen::Vector3f::Zero());
  for_each_with_local(points, dense, guess, [&](LocalPoints& local, std::uint32_t i) {
    if (normals[i].isZero()) {
      thread_local std::vector<Neighbour> found;
      local.find_nearest_unsorted(points.positions()[i], fitted, found);
      normals[i] = fit_normal(dense, points.positions()[i], found);
    }
  });
  return normals;
}

}  // namespace tactree::builder
