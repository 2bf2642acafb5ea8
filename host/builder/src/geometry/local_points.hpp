#pragma once
// The points around a block of neighbouring positions, copied once and searched for each of them.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>
#include <vector>

#include "geometry/z_order.hpp"

namespace tactree::builder {

class LocalPoints {
 public:
  /// Copies all points of the cloud within `radius` of the box.
  void gather(const ZOrderedCloud& cloud, const Box& box, double radius);
  /// Copies those of the points that visit_all(visit) passes to visit(position, index).
  template <typename VisitAll>
  void gather_from(const Box& box, double radius, VisitAll&& visit_all) {
    begin(radius);
    const double squared_radius = radius * radius;
    visit_all([&](const Eigen::Vector3d& p, std::uint32_t index) {
      if (box.squaredExteriorDistance(p) <= squared_radius) {
        x_.push_back(p.x());
        y_.push_back(p.y());
        z_.push_back(p.z());
        index_.push_back(index);
      }
    });
    end();
  }

  /// Calls visit(index, squared_distance) for every point within `radius` of `centre`, in a fixed
  /// order. Precondition: in the box, or a radius that is smaller by the distance from it.
  template <typename Visit>
  void visit_within(const Eigen::Vector3d& centre, double radius, Visit&& visit) {
    measure(centre);
    const double squared_radius = radius * radius;
    for (std::size_t k = 0; k < index_.size(); ++k) {
      if (squared_[k] <= squared_radius) {
        visit(index_[k], squared_[k]);
      }
    }
  }

  /// The same as ZOrderedCloud::find_nearest_unsorted() of the cloud, for a position in the box.
  void find_nearest_unsorted(const Eigen::Vector3d& centre, std::size_t count,
                             std::vector<Neighbour>& found);

 private:
  void begin(double radius);
  void end();
  /// Computes the squared distances of all points from `centre`.
  void measure(const Eigen::Vector3d& centre);

  const ZOrderedCloud* cloud_ = nullptr;
  double radius_ = 0.0;
  // One more than points if their number is odd, except of indices.
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> z_;
  std::vector<double> squared_;
  std::vector<std::uint32_t> index_;
};

/// Minimum edge of the blocks of points that are searched together, in radii of the search.
inline constexpr double kBlockRadii = 1.0;

/// Calls work(local, i) for each point i of `points`, in parallel. `local` holds the points of
/// `cloud` within `radius` of the point, among others.
template <typename Work>
void for_each_with_local(const ZOrderedCloud& points, const ZOrderedCloud& cloud, double radius,
                         Work&& work) {
  const std::vector<CellRange> blocks = points.cells(points.level_for_edge(kBlockRadii * radius));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 16), [&](auto range) {
    LocalPoints local;
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      Box box;
      for (std::uint32_t i = blocks[b].first; i < blocks[b].last; ++i) {
        box.extend(points.positions()[i]);
      }
      local.gather(cloud, box, radius);
      for (std::uint32_t i = blocks[b].first; i < blocks[b].last; ++i) {
        work(local, i);
      }
    }
  });
}

}  // namespace tactree::builder
