#pragma once
// Names and colours of the materials of a blob, which stores none.

#include <optional>
#include <string>

#include "tactree/builder/materials.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::cli {

/// Reads the materials of the build; empty if `file` is empty. Throws UserError if they are not
/// those of the blob.
[[nodiscard]] std::optional<builder::MaterialMap> named_materials(const std::string& file,
                                                                  const std::string& blob,
                                                                  const core::BlobView& view);

}  // namespace tactree::cli
