#pragma once
// A model of another size, from its blob instead of its scan.

#include "tactree/builder/model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::builder {

/// The same points at `scale` times their coordinates, with lengths larger by that factor; the
/// materials are unchanged. Throws std::runtime_error if such a model cannot be represented. Cost:
/// that of write_blob(). Precondition: scale > 0.
[[nodiscard]] WrittenBlob scaled_model(const core::BlobView& view, double scale);

}  // namespace tactree::builder
