#pragma once
// What a model is at a position: contact, nearest point, surface, inside or outside.

#include <cstdint>
#include <optional>
#include <vector>

#include "tactree/core/contact/surface.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/core/model/nearest.hpp"

namespace tactree::support {

struct PointAnswer {
  bool contact_paper = false;  ///< by the method of the paper
  bool contact = false;        ///< within the box of any point
  std::uint32_t nearest = core::kNoPoint;
  double distance_m = 0.0;  ///< to the nearest point, if there is one within the radius
  core::SurfaceProjection surface;
  std::optional<bool> inside;  ///< empty if the blob does not contain an interior
};

/// Search radius of a query if the user gives none: the support radius, if the blob has one.
[[nodiscard]] float default_query_radius_m(const core::BlobView& view);

/// Uses the queries of the controller, which are exact up to the reach of the blob. For larger
/// radii, which a controller never uses, all points are searched. For one thread at a time.
class PointQuery {
 public:
  /// The bytes of the blob must outlive the query.
  PointQuery(const core::BlobView& view, float radius_m);

  /// True if all points are searched.
  [[nodiscard]] bool exhaustive() const { return !points_.empty(); }

  [[nodiscard]] PointAnswer answer(core::Vec3 probe);

 private:
  [[nodiscard]] bool is_in_material(core::Vec3 probe, const core::SurfaceProjection& surface) const;
  [[nodiscard]] bool in_any_box(core::Vec3 probe) const;
  [[nodiscard]] core::NearestPoint nearest_of_all(core::Vec3 probe) const;

  core::BlobView view_;
  float radius_m_;
  bool nearest_exact_;
  bool boxes_exact_;
  bool has_surface_;
  std::vector<core::SurfacePoint> points_;
  core::CandidateSet candidates_;
};

}  // namespace tactree::support
