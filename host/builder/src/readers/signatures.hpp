#pragma once
// Signatures of formats that have no reader: first bytes, keywords of lines, XML elements.

#include <cstddef>
#include <span>
#include <string_view>

namespace tactree::builder {

/// Bytes at an offset, or a word at the beginning of a line or in an XML file.
struct Signature {
  std::size_t at = 0;
  std::string_view bytes;
  const char* name = "";
  const char* remedy = "";
};

/// First bytes of files that are not text.
[[nodiscard]] std::span<const Signature> binary_signatures();

/// Beginnings of the first line, or of one of the comments before it. Whole words if they end with
/// a letter.
[[nodiscard]] std::span<const Signature> first_line_signatures();

/// Beginnings of any line, in the same form; '=' may follow white space.
[[nodiscard]] std::span<const Signature> line_signatures();

/// Parts of an XML file.
[[nodiscard]] std::span<const Signature> xml_signatures();

}  // namespace tactree::builder
