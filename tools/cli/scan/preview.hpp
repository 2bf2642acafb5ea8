#pragma once
// A picture of a model with its openings marked, as a PNG file.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "tactree/builder/build_model.hpp"
#include "tactree/core/model/blob.hpp"

namespace tactree::cli {

/// Writes the picture. `doubtful` is empty, or 1 for each point with an ambiguous orientation.
/// `named` are the materials of the build, if they are known: a model with several is drawn in
/// their colours. Others are drawn in `colours`, one per point, unless that is empty. Throws
/// UserError if the file cannot be written.
void write_preview(const std::filesystem::path& file, const core::BlobView& view,
                   std::span<const builder::Opening> openings,
                   std::span<const std::uint8_t> doubtful,
                   const std::optional<builder::MaterialMap>& named,
                   std::span<const builder::Colour> colours);

}  // namespace tactree::cli
