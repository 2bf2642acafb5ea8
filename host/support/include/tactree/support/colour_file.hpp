#pragma once
// The colours of the points of a blob, in a file of their own, which no board reads
// (docs/FORMAT.md, "Colours of the scan").

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "tactree/support/blob_file.hpp"

namespace tactree::support {

using PointColour = std::array<std::uint8_t, 3>;  ///< R, G, B

/// Writes the colours of the points of `blob`, in the order of its points. Throws UserError.
void write_colours(const std::filesystem::path& file, std::span<const std::byte> blob,
                   std::span<const PointColour> colours);

/// One per point of `blob`, whose name is that of messages. Throws UserError, also if the file
/// belongs to another blob.
[[nodiscard]] std::vector<PointColour> read_colours(const std::filesystem::path& file,
                                                    const BlobFile& blob, const std::string& name);

}  // namespace tactree::support
