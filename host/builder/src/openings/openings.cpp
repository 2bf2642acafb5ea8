#include "tactree/builder/openings.hpp"

#include <utility>

#include "geometry/z_order.hpp"
#include "openings/gaps.hpp"

namespace tactree::builder {

std::vector<Opening> find_openings(const core::BlobView& view) {
  Cloud cloud;
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint p = view.surface_point(leaf, index);
    cloud.positions.push_back(
        Eigen::Vector3f(p.position.x, p.position.y, p.position.z).cast<double>());
    cloud.normals.emplace_back(p.normal.x, p.normal.y, p.normal.z);
  });
  return find_gaps(ZOrderedCloud(std::move(cloud)), static_cast<double>(view.header().spacing_m),
                   static_cast<double>(view.header().support_radius_m))
      .openings;
}

}  // namespace tactree::builder
