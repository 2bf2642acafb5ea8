#pragma once
// Material and free space around a surface, as the builder has marked them in the octree of a blob.
//
// Interrupt safety: pure functions.

#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// What a blob tells about a place. Both are false outside the root cube, and in a blob without an
/// interior.
struct Interior {
  bool here = false;    ///< the place lies in the material, if no point is within reach of it
  bool behind = false;  ///< in a leaf: there is material behind its points
};

/// Cost: one descent from the root, at most depth() levels of about 25 instructions.
[[nodiscard]] Interior interior_at(const BlobView& view, Vec3 position);

}  // namespace tactree::core
