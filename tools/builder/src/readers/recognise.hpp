#pragma once
// What a file is, told from its first bytes and its size. Names and extensions play no part.

#include <cstdint>
#include <string>
#include <string_view>

namespace tactree::builder {

enum class FileKind : std::uint8_t {
  kPly,
  kPcd,
  kObj,
  kOff,
  kStlAscii,
  kStlBinary,
  kImportedMesh,  ///< for the mesh import process
  kText,          ///< maybe rows of numbers
  kUnsupported,   ///< known, or unknown, but not readable
};

struct Recognition {
  FileKind kind = FileKind::kUnsupported;
  std::string name;    ///< for people, e.g. "LAZ (compressed LAS)"
  std::string remedy;  ///< kUnsupported: what the user can do
  std::string hint;    ///< kImportedMesh: the usual extension, e.g. "glb"
};

/// How many of the first bytes recognise() looks at.
inline constexpr std::size_t kHeadBytes = std::size_t{1} << 18;

/// head: the first bytes of the file, up to kHeadBytes; file_size: of the whole file.
[[nodiscard]] Recognition recognise(std::string_view head, std::uint64_t file_size);

}  // namespace tactree::builder
