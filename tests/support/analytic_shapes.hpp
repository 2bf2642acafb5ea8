#pragma once
// The surfaces of `tactree evaluate`, under the tests' name.

#include "tactree/evaluation/shapes.hpp"

namespace tactree::test {
using namespace evaluation;  // NOLINT(google-build-using-namespace): one name for both

/// A plane of the first material where x < 0, of the second elsewhere.
inline Shape two_materials(const core::BlobMaterial& left, const core::BlobMaterial& right) {
  Shape shape;
  add_sheet(shape, 0.02, 0.0, 1.0);
  shape.model().materials = {left, right};
  for (const Eigen::Vector3d& p : shape.model().positions) {
    shape.model().material_indices.push_back(p.x() < 0.0 ? 0 : 1);
  }
  shape.seal();
  return shape;
}
}  // namespace tactree::test
