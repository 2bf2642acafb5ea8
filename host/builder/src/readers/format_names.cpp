// Maps the format names that a user gives, which are file name extensions, to formats.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "number.hpp"
#include "recognise.hpp"

namespace tactree::builder {
namespace {

struct NamedFormat {
  std::string_view extension;
  FileKind kind;
  std::string_view shown;
};

constexpr std::array kFormats = {
    NamedFormat{"ply", FileKind::kPly, "PLY"},
    NamedFormat{"pcd", FileKind::kPcd, "PCD"},
    NamedFormat{"ptx", FileKind::kPtx, "PTX"},
    NamedFormat{"e57", FileKind::kE57, "E57"},
    NamedFormat{"las", FileKind::kLas, "LAS"},
    NamedFormat{"xyz", FileKind::kText, "text"},
    NamedFormat{"pts", FileKind::kText, "text"},
    NamedFormat{"csv", FileKind::kText, "text"},
    NamedFormat{"txt", FileKind::kText, "text"},
    NamedFormat{"obj", FileKind::kObj, "OBJ"},
    NamedFormat{"stl", FileKind::kStlAscii, "STL"},
    NamedFormat{"off", FileKind::kOff, "OFF"},
    NamedFormat{"glb", FileKind::kImportedMesh, "glTF binary (GLB)"},
    NamedFormat{"gltf", FileKind::kImportedMesh, "glTF"},
    NamedFormat{"3mf", FileKind::kImportedMesh, "3MF"},
    NamedFormat{"fbx", FileKind::kImportedMesh, "FBX"},
    NamedFormat{"dae", FileKind::kImportedMesh, "COLLADA"},
    NamedFormat{"3ds", FileKind::kImportedMesh, "3DS"},
    NamedFormat{"x3d", FileKind::kImportedMesh, "X3D"},
    NamedFormat{"amf", FileKind::kImportedMesh, "AMF"},
    NamedFormat{"wrl", FileKind::kImportedMesh, "VRML"},
};

/// The text form of a format that also has a binary one.
FileKind family(FileKind kind) {
  if (kind == FileKind::kStlBinary) return FileKind::kStlAscii;
  return kind == FileKind::kOffBinary ? FileKind::kOff : kind;
}

FileKind binary_form(FileKind kind) {
  if (kind == FileKind::kStlAscii) return FileKind::kStlBinary;
  return kind == FileKind::kOff ? FileKind::kOffBinary : kind;
}

/// True if the content identifies a format that has a reader, other than a table of text.
bool is_definite(const Recognition& found) {
  return found.kind != FileKind::kText && found.kind != FileKind::kUnsupported;
}

}  // namespace

std::vector<std::string> scan_formats() {
  std::vector<std::string> names;
  for (const NamedFormat& format : kFormats) names.emplace_back(format.extension);
  return names;
}

Recognition recognise_as(std::string_view extension, std::string_view head,
                         std::uint64_t file_size) {
  const auto* const format = std::find_if(
      kFormats.begin(), kFormats.end(),
      [&](const NamedFormat& known) { return equal_ignoring_case(known.extension, extension); });
  if (format == kFormats.end()) {
    return {FileKind::kUnsupported, fmt::format("of a format that has no reader: {}", extension),
            fmt::format("the formats are {}", fmt::join(scan_formats(), ", ")), ""};
  }
  Recognition found = recognise(head, file_size);
  const bool text = is_text(head);
  const bool same =
      family(found.kind) == format->kind && (found.hint.empty() || found.hint == format->extension);
  if (same) return found;
  const bool as_table = format->kind == FileKind::kText && text;
  if (is_definite(found) && !as_table) {
    return {FileKind::kUnsupported,
            fmt::format("{} by its content, not {}", found.name, format->shown), "omit --format",
            ""};
  }
  // LAZ is compressed LAS. Its own error message names a program that unpacks it.
  const bool packed = format->kind == FileKind::kLas && head.starts_with("LASF");
  if (packed || (format->kind == FileKind::kText && !text)) return found;
  return {text ? format->kind : binary_form(format->kind), std::string(format->shown), "",
          std::string(format->kind == FileKind::kImportedMesh ? format->extension : "")};
}

}  // namespace tactree::builder
