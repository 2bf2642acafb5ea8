#pragma once
// Recognises text formats of meshes, grids and CAD that have no reader, and binary formats with a
// magic number. They are reported by name, so that their numbers are never read as points.

#include <optional>
#include <span>
#include <string_view>

#include "recognise.hpp"

namespace tactree::builder {

/// Returns the format of a file by its first bytes, if it is known and has no reader. `text` is
/// is_text(head): some signatures are so short that text may begin with them.
[[nodiscard]] std::optional<Recognition> recognise_by_signature(std::string_view head, bool text);

/// Returns the format of a file by the keywords and the structure of its lines, if it is known and
/// has no reader. Files of a format that has a reader may contain these keywords.
[[nodiscard]] std::optional<Recognition> recognise_by_lines(std::string_view head);

/// Like recognise_by_lines(), for formats with rows of numbers after a line of counts: TetGen,
/// AVS-UCD, UGRID, FreeFem, OFF without its keyword. `lines` are the first lines of the file,
/// without blank lines and comments.
[[nodiscard]] std::optional<Recognition> recognise_counted_format(
    std::span<const std::string_view> lines);

}  // namespace tactree::builder
