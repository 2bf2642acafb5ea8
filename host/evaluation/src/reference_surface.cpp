#include "reference_surface.hpp"

#include <cmath>

#include "tactree/evaluation/shapes.hpp"

namespace tactree::evaluation {

using Eigen::Vector3d;

struct ReferenceSurface::Fit {
  bool supported = false;
  double distance = 0.0;
  Vector3d normal = Vector3d::Zero();
};

ReferenceSurface::ReferenceSurface(const core::BlobView& view)
    : radius_(static_cast<double>(view.header().support_radius_m)) {
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint point = view.surface_point(leaf, index);
    positions_.push_back(widen(point.position));
    normals_.push_back(widen(point.normal));
  });
}

// Guennebaud and Gross, "Algebraic Point Set Surfaces", section 4.1, in the query's frame.
ReferenceSurface::Fit ReferenceSurface::fit(const std::vector<std::size_t>& around,
                                            const Vector3d& x, const Vector3d& reference) const {
  double w_sum = 0.0;
  double qq_sum = 0.0;
  double qn_sum = 0.0;
  Vector3d q_sum = Vector3d::Zero();
  Vector3d n_sum = Vector3d::Zero();
  for (const std::size_t i : around) {
    const Vector3d q = positions_[i] - x;
    const double u = 1.0 - q.squaredNorm() / (radius_ * radius_);
    if (u <= 0.0 || normals_[i].dot(reference) <= 0.0) {
      continue;
    }
    const double w = u * u * u * u;
    w_sum += w;
    q_sum += w * q;
    n_sum += w * normals_[i];
    qq_sum += w * q.squaredNorm();
    qn_sum += w * q.dot(normals_[i]);
  }
  if (w_sum <= 0.0) {
    return {};
  }
  const double spread = qq_sum - q_sum.squaredNorm() / w_sum;
  const double quadratic =
      spread < 1e-3 * qq_sum ? 0.0 : 0.5 * (qn_sum - q_sum.dot(n_sum) / w_sum) / spread;
  const Vector3d linear = (n_sum - 2.0 * quadratic * q_sum) / w_sum;
  const double constant = -(linear.dot(q_sum) + quadratic * qq_sum) / w_sum;
  const double slope = linear.norm();
  if (slope < 1e-6) {
    return {};
  }
  const double root = std::sqrt(std::max(0.0, slope * slope - 4.0 * constant * quadratic));
  return {true, 2.0 * constant / (slope + root), linear / slope};
}

ReferenceSurface::Projection ReferenceSurface::project(const Vector3d& x) const {
  std::vector<std::size_t> around;  // all points that a projection step may need
  std::size_t nearest = positions_.size();
  double best = radius_ * radius_;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const double squared = (positions_[i] - x).squaredNorm();
    if (squared < 4.0 * radius_ * radius_) {
      around.push_back(i);
    }
    if (squared < best) {
      best = squared;
      nearest = i;
    }
  }
  Projection result;
  if (nearest == positions_.size()) {
    return result;
  }
  Vector3d normal = normals_[nearest];
  Vector3d at = x;
  double side = 0.0;
  for (int i = 0; i < 30; ++i) {
    const Fit found = fit(around, at, normal);
    if (!found.supported) {
      return result;
    }
    side = i == 0 ? found.distance : side;
    at -= found.distance * found.normal;
    normal = found.normal;
    if (std::abs(found.distance) < 1e-12) {
      break;
    }
  }
  result.supported = true;
  result.point = at;
  result.normal = normal;
  result.signed_distance = std::copysign((x - at).norm(), side);
  result.creased = is_creased(around, x) || is_creased(around, at);
  return result;
}

bool ReferenceSurface::is_creased(const std::vector<std::size_t>& around, const Vector3d& x) const {
  std::vector<std::size_t> close;
  for (const std::size_t i : around) {
    if ((positions_[i] - x).norm() < radius_) {
      close.push_back(i);
    }
  }
  for (const std::size_t i : close) {
    for (const std::size_t j : close) {
      if (normals_[i].dot(normals_[j]) < 0.68) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace tactree::evaluation
