#pragma once
// Distinguishes material from free space around a surface, by flags that the builder stores in the
// octree of a blob.
//
// Interrupt safety: pure functions.

#include "tactree/core/model/blob.hpp"

namespace tactree::core {

/// Interior flags at a position. Both are false outside the root cube, and in a blob without an
/// interior.
struct Interior {
  bool here = false;    ///< in the material; valid only if no point is within reach_m()
  bool behind = false;  ///< in a leaf whose points have material behind them
};

/// Cost: one descent from the root, at most depth() levels of about 25 instructions.
[[nodiscard]] Interior interior_at(const BlobView& view, Vec3 position);

}  // namespace tactree::core
