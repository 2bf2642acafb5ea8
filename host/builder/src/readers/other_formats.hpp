#pragma once
// Text formats of meshes, grids and CAD that have no reader, and binary ones with a magic number.
// They are named, so that their numbers are never taken for points.

#include <optional>
#include <span>
#include <string_view>

#include "recognise.hpp"

namespace tactree::builder {

/// The format of a file that begins with `head` if it is known and has no reader.
[[nodiscard]] std::optional<Recognition> recognise_other_format(std::string_view head);

/// The same for rows of numbers after a line of counts: TetGen, AVS-UCD, UGRID, FreeFem. lines: the
/// first ones without blank lines and comments.
[[nodiscard]] std::optional<Recognition> recognise_counted_format(
    std::span<const std::string_view> lines);

}  // namespace tactree::builder
