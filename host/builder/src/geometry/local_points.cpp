#include "geometry/local_points.hpp"

#include <cstring>

namespace tactree::builder {
namespace {

using Pair = double __attribute__((vector_size(16)));

Pair load(const double* at) {
  Pair pair;
  std::memcpy(&pair, at, sizeof pair);
  return pair;
}

}  // namespace

void LocalPoints::gather(const ZOrderedCloud& cloud, const Box& box, double radius) {
  cloud_ = &cloud;
  gather_from(box, radius, [&](auto&& visit) {
    cloud.visit_cells(box.min().array() - radius, box.max().array() + radius,
                      cloud.level_for_edge(radius), [&](CellRange range) {
                        for (std::uint32_t i = range.first; i < range.last; ++i) {
                          visit(cloud.positions()[i], i);
                        }
                      });
  });
}

void LocalPoints::begin(double radius) {
  radius_ = radius;
  x_.clear();
  y_.clear();
  z_.clear();
  index_.clear();
}

void LocalPoints::end() {
  const std::size_t even = (index_.size() + 1) / 2 * 2;
  x_.resize(even);
  y_.resize(even);
  z_.resize(even);
  squared_.resize(even);
}

void LocalPoints::measure(const Eigen::Vector3d& centre) {
  for (std::size_t k = 0; k < squared_.size(); k += 2) {
    const Pair dx = load(&x_[k]) - centre.x();
    const Pair dy = load(&y_[k]) - centre.y();
    const Pair dz = load(&z_[k]) - centre.z();
    const Pair sum = dx * dx + (dy * dy + dz * dz);
    std::memcpy(&squared_[k], &sum, sizeof sum);
  }
}

void LocalPoints::find_nearest_unsorted(const Eigen::Vector3d& centre, std::size_t count,
                                        std::vector<Neighbour>& found) {
  measure(centre);
  const std::size_t size = index_.size();
  found.resize(size);
  std::size_t near = 0;
  for (std::size_t k = 0; k < size; ++k) {
    found[near] = {squared_[k], index_[k]};
    near += squared_[k] <= radius_ * radius_ ? 1U : 0U;
  }
  found.resize(near);
  if (near < count) {
    cloud_->find_nearest_unsorted(centre, count, 2.0 * radius_, found);
  } else {
    keep_nearest(count, found);
  }
}

}  // namespace tactree::builder
