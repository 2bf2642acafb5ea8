#pragma once
// Octahedral normals, 9 + 9 bits: the encoder of what core's BlobView::normal() decodes.

#include <Eigen/Core>
#include <cstdint>

namespace tactree::builder {

/// The code whose decoded direction is closest to `normal` (need not have unit length).
[[nodiscard]] std::uint32_t encode_normal(const Eigen::Vector3f& normal);
[[nodiscard]] Eigen::Vector3d decode_normal(std::uint32_t code);

}  // namespace tactree::builder
