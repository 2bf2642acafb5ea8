#include "tactree/builder/scaled_model.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

namespace tactree::builder {
namespace {

double to_double(core::BlobDouble words) {
  return std::bit_cast<double>(std::uint64_t{words.high} << 32U | words.low);
}

void copy_points(const core::BlobView& view, double scale, Model& model) {
  core::for_each_point(view, [&](const core::Leaf& leaf, std::uint32_t index) {
    const core::SurfacePoint point = view.surface_point(leaf, index);
    const Eigen::Vector3f position(point.position.x, point.position.y, point.position.z);
    model.positions.emplace_back(scale * position.cast<double>());
    model.normals.emplace_back(point.normal.x, point.normal.y, point.normal.z);
    if (view.material_count() > 1) {
      model.material_indices.push_back(static_cast<std::uint8_t>(view.material_of(index)));
    }
  });
}

}  // namespace

WrittenBlob scaled_model(const core::BlobView& view, double scale) {
  const core::BlobHeader& header = view.header();
  Model model;
  copy_points(view, scale, model);
  for (std::uint32_t i = 0; i < view.material_count(); ++i) {
    model.materials.push_back(view.material(i));
  }
  model.spacing_m = scale * static_cast<double>(header.spacing_m);
  model.support_radius_m = scale * static_cast<double>(header.support_radius_m);
  model.reach_m = scale * static_cast<double>(header.reach_m);
  model.largest_gap_m = scale * static_cast<double>(header.largest_gap_m);
  model.profile = static_cast<core::Profile>(header.profile);
  model.tells_interior = view.interior() != nullptr;
  model.source_scale = scale * to_double(header.source_scale);
  for (int axis = 0; axis < 3; ++axis) {
    model.source_origin[axis] = to_double(header.source_origin[axis]);
  }
  model.name = header.name;
  std::copy(std::begin(header.source_digest), std::end(header.source_digest),
            model.source_digest.begin());
  return write_blob(model);
}

}  // namespace tactree::builder
