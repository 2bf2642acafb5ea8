#include "octree/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/normal_code.hpp"

namespace tactree::builder {
namespace {

constexpr int kMaxShift = 2;  // on each axis, from the site that contains the position

// Cost of the distance from the position, relative to that from the plane. Of sites that are
// equally close to the plane, the one closest to the position is taken.
constexpr double kShiftCost = 0.02;

// Another site must be better than the one that contains the position by more than this. The points
// of a plane between two layers of sites are then in one layer, even if the plane or the normals
// are inclined by a rounding error.
constexpr double kLeastGain = 1e-3;

// Points whose normals differ by more than 18 degrees may belong to different faces. A fit
// separates these, so their errors do not compensate.
constexpr float kSameFaceCosine = 0.95F;

struct Share {
  std::size_t point;
  double weight;
};

}  // namespace

Eigen::Vector3i site_on_plane(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, int last) {
  const Eigen::Vector3i nearest = at.array().floor().cast<int>().max(0).min(last).matrix();
  int axis = 0;
  if (!(normal.cwiseAbs().maxCoeff(&axis) > 0.0)) {
    return nearest;
  }
  const int second = (axis + 1) % 3;
  const int third = (axis + 2) % 3;
  const Eigen::Vector3d offset = (nearest.cast<double>().array() + 0.5).matrix() - at;
  const auto cost_of = [&](const Eigen::Vector3d& error) {
    return std::abs(normal.dot(error)) + kShiftCost * error.norm();
  };
  Eigen::Vector3i best = nearest;
  double least = cost_of(offset) - kLeastGain;
  for (int i = -kMaxShift; i <= kMaxShift; ++i) {
    for (int j = -kMaxShift; j <= kMaxShift; ++j) {
      Eigen::Vector3i shift;
      shift[second] = i;
      shift[third] = j;
      shift[axis] = 0;
      const double to_plane = -normal.dot(offset + shift.cast<double>()) / normal[axis];
      shift[axis] =
          static_cast<int>(std::clamp(std::round(to_plane), -1.0 * kMaxShift, 1.0 * kMaxShift));
      const Eigen::Vector3i site = nearest + shift;
      const double cost = cost_of(offset + shift.cast<double>());
      if (cost < least && site.minCoeff() >= 0 && site.maxCoeff() <= last) {
        least = cost;
        best = site;
      }
    }
  }
  return best;
}

void encode_normals(std::span<const Eigen::Vector3d> positions,
                    std::span<const Eigen::Vector3f> normals, double radius,
                    std::span<std::uint32_t> codes) {
  std::vector<Eigen::Vector3d> wanted(normals.size());
  std::transform(normals.begin(), normals.end(), wanted.begin(),
                 [](const Eigen::Vector3f& normal) { return normal.cast<double>(); });
  std::vector<Share> shares;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    codes[i] = encode_normal(wanted[i]);
    const Eigen::Vector3d error = wanted[i].normalized() - decode_normal(codes[i]);
    shares.clear();
    double sum = 0.0;
    for (std::size_t k = i + 1; k < wanted.size() && positions[k].z() - positions[i].z() < radius;
         ++k) {
      const double weight = 1.0 - (positions[k] - positions[i]).squaredNorm() / (radius * radius);
      if (weight > 0.0 && normals[i].dot(normals[k]) > kSameFaceCosine) {
        shares.push_back({k, weight});
        sum += weight;
      }
    }
    for (const Share& share : shares) {
      wanted[share.point] += share.weight / sum * error;
    }
  }
}

}  // namespace tactree::builder
