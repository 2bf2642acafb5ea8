#pragma once
// Recognises the format of a file by its first bytes and its size, not by its name.

#include <cstdint>
#include <string>
#include <string_view>

#include "tactree/builder/read_scan.hpp"

namespace tactree::builder {

enum class FileKind : std::uint8_t {
  kPly,
  kPcd,
  kPtx,
  kE57,
  kLas,
  kObj,
  kOff,
  kOffBinary,
  kStlAscii,
  kStlBinary,
  kImportedMesh,  ///< read by the mesh import process
  kText,          ///< possibly rows of numbers
  kUnsupported,   ///< no reader
};

struct Recognition {
  FileKind kind = FileKind::kUnsupported;
  std::string name;    ///< for messages, e.g. "LAZ (compressed LAS)"
  std::string remedy;  ///< kUnsupported: an action for the user
  std::string hint;    ///< kImportedMesh: the usual extension, e.g. "glb"
};

/// Number of leading bytes that recognise() inspects.
inline constexpr std::size_t kHeadBytes = std::size_t{1} << 18;

/// `head` is the first bytes of the file, up to kHeadBytes; `file_size` is that of the whole file.
[[nodiscard]] Recognition recognise(std::string_view head, std::uint64_t file_size);

/// Like recognise(), but the user has named the format by an extension of scan_formats(). The
/// content selects between its text and its binary form. If the content is certainly another
/// format, the result is kUnsupported.
[[nodiscard]] Recognition recognise_as(std::string_view extension, std::string_view head,
                                       std::uint64_t file_size);

/// True if the bytes can be text: no control characters except white space.
[[nodiscard]] bool is_text(std::string_view head);

}  // namespace tactree::builder
