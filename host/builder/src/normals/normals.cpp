#include "normals/normals.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactree::builder {
namespace {

constexpr double kFitSpacings = 1.5;
constexpr std::size_t kLeastFitted = 12;
constexpr std::size_t kMaxFitted = 96;

// Normal of the plane through neighbours sorted by distance. Nearer neighbours have more weight.
Eigen::Vector3f fit_normal(const ZOrderedCloud& dense, const std::vector<Neighbour>& neighbours) {
  const double radius_squared = 1.2 * neighbours.back().squared_distance + 1e-300;
  double weight_sum = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& centre = dense.positions()[neighbours.front().index];
  for (const Neighbour& n : neighbours) {
    const double weight = 1.0 - n.squared_distance / radius_squared;
    weight_sum += weight;
    mean += weight * (dense.positions()[n.index] - centre);
  }
  mean /= weight_sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : neighbours) {
    const Eigen::Vector3d d = dense.positions()[n.index] - centre - mean;
    covariance += (1.0 - n.squared_distance / radius_squared) * d * d.transpose();
  }
  covariance /= std::max(covariance.trace(), 1e-300);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
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
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](auto range) {
    std::vector<Neighbour> found;
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (normals[i].isZero()) {
        dense.find_nearest(points.positions()[i], fitted, guess, found);
        normals[i] = fit_normal(dense, found);
      }
    }
  });
  return normals;
}

}  // namespace tactree::builder
