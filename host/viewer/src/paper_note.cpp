#include "paper_note.hpp"

#include <fmt/format.h>

#include "tactree/core/model/interior.hpp"
#include "tactree/core/model/nearest.hpp"

namespace tactree::viewer {
namespace {

bool is_behind_surface(const core::BlobView& view, core::Vec3 probe) {
  if (view.header().profile != static_cast<std::uint32_t>(core::Profile::kSurface)) {
    return false;  // nearest_within() is not exact
  }
  const core::NearestPoint nearest = core::nearest_within(view, probe, view.reach_m());
  return nearest.found() ? core::dot(probe - nearest.position, view.normal(nearest.index)) < 0.0F
                         : core::interior_at(view, probe).here;
}

}  // namespace

std::string paper_note(const simulation::Sample& sample, const Bodies& bodies) {
  const core::Status& status = sample.status;
  if (status.state != core::State::kActive || status.rendering.in_contact) {
    return "";
  }
  for (std::size_t i = 0; i < bodies.views.size(); ++i) {
    const core::BlobView& view = bodies.views[i];
    const core::Pose pose = bodies.bodies[i].path.at(sample.t_s).pose;
    if (is_behind_surface(view, core::position_to_body(pose, status.probe))) {
      return fmt::format(
          "no force: the method of the paper finds a contact only within {:.2g} mm of a point, and "
          "the hand has passed the points (draw it back, or choose the mode surface)",
          500.0 * static_cast<double>(view.header().aabb_edge_m));
    }
  }
  return "";
}

}  // namespace tactree::viewer
