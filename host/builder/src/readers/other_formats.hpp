#pragma once
// Recognises text formats of meshes, grids and CAD that have no reader, and binary formats with a
// magic number. They are reported by name, so that their numbers are never read as points.

#include <optional>
#include <span>
#include <string_view>

#include "recognise.hpp"

namespace tactree::builder {

/// Returns the format of a file that begins with `head`, if it is known and has no reader.
[[nodiscard]] std::optional<Recognition> recognise_other_format(std::string_view head);

/// Like recognise_other_format(), for formats with rows of numbers after a line of counts: TetGen,
/// AVS-UCD, UGRID, FreeFem. `lines` are the first lines of the file, without blank lines and
/// comments.
[[nodiscard]] std::optional<Recognition> recognise_counted_format(
    std::span<const std::string_view> lines);

}  // namespace tactree::builder
