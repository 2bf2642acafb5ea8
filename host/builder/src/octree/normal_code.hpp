#pragma once
// Encoder of octahedral normals, 9 + 9 bits. Decoder: BlobView::normal() in core.

#include <Eigen/Core>
#include <cstdint>

namespace tactree::builder {

/// The code whose decoded direction is closest to `normal` (of any length > 0).
[[nodiscard]] std::uint32_t encode_normal(const Eigen::Vector3d& normal);
[[nodiscard]] Eigen::Vector3d decode_normal(std::uint32_t code);

}  // namespace tactree::builder
