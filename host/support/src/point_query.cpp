#include "tactree/support/point_query.hpp"

#include <cmath>

#include "tactree/core/contact/paper_mode.hpp"
#include "tactree/core/model/interior.hpp"
#include "tactree/support/blob_file.hpp"

namespace tactree::support {

using core::Vec3;

float default_query_radius_m(const core::BlobView& view) {
  const core::BlobHeader& header = view.header();
  return header.support_radius_m > 0.0F ? header.support_radius_m : header.reach_m;
}

PointQuery::PointQuery(const core::BlobView& view, float radius_m)
    : view_(view),
      radius_m_(radius_m),
      nearest_exact_(radius_m <= view.reach_m()),
      boxes_exact_(0.5F * view.header().aabb_edge_m <= view.reach_m()),
      has_surface_(core::surface_support(view) == core::SurfaceSupport::kOk) {
  if (!nearest_exact_ || !boxes_exact_) {
    points_ = decode_points(view);
  }
}

PointAnswer PointQuery::answer(Vec3 probe) {
  PointAnswer answer;
  answer.contact_paper = core::paper_collision(view_, probe).in_contact;
  answer.contact = boxes_exact_ ? core::in_any_vertex_box(view_, probe) : in_any_box(probe);
  const core::NearestPoint nearest =
      nearest_exact_ ? core::nearest_within(view_, probe, radius_m_) : nearest_of_all(probe);
  answer.nearest = nearest.index;
  answer.distance_m = std::sqrt(static_cast<double>(nearest.distance_squared));
  if (has_surface_) {
    answer.surface = core::project_to_surface(view_, probe, candidates_);
  }
  if (view_.interior() != nullptr) {
    answer.inside = is_in_material(probe, answer.surface);
  }
  return answer;
}

/// Uses the rule of Proxy::inside(). Precondition: candidates_ are those of the projection.
bool PointQuery::is_in_material(Vec3 probe, const core::SurfaceProjection& surface) const {
  if (!surface.supported) {
    return core::interior_at(view_, probe).here;
  }
  return surface.signed_distance < 0.0F && core::interior_at(view_, candidates_[0].position).behind;
}

bool PointQuery::in_any_box(Vec3 probe) const {
  const float half = 0.5F * view_.header().aabb_edge_m;
  for (const core::SurfacePoint& p : points_) {
    const Vec3 d = p.position - probe;
    if (std::abs(d.x) <= half && std::abs(d.y) <= half && std::abs(d.z) <= half) {
      return true;
    }
  }
  return false;
}

core::NearestPoint PointQuery::nearest_of_all(Vec3 probe) const {
  core::NearestPoint best;
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    const float squared = length_squared(points_[i].position - probe);
    if (squared <= radius_m_ * radius_m_ && (!best.found() || squared < best.distance_squared)) {
      best.index = i;
      best.distance_squared = squared;
    }
  }
  return best;
}

}  // namespace tactree::support
