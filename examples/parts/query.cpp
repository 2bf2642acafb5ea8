// Where is the surface? A model that open_blob() has accepted, a position, and no state.
#include "tactree/core/contact/surface.hpp"

using namespace tactree::core;

bool open(std::span<const std::byte> blob, BlobView& model) {
  return open_blob(blob, model) == BlobStatus::kOk;
}

/// Metres in front of the surface, negative behind it; `normal` points to its front.
float distance_at(const BlobView& model, Vec3 probe, Vec3& normal) {
  const auto surface = project_to_surface(model, probe);
  normal = surface.normal;
  return surface.signed_distance;
}
