#pragma once
// A picture of a model with its openings marked, as a PNG file.

#include <filesystem>
#include <span>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/blob.hpp"

namespace tactree::cli {

/// Throws CommandError where the file cannot be written.
void write_preview(const std::filesystem::path& file, const core::BlobView& view,
                   std::span<const builder::Opening> openings);

}  // namespace tactree::cli
