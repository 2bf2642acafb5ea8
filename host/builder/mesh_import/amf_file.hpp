#pragma once
// Reads an AMF file (ISO/ASTM 52915): the objects as its constellations place them. The reader of
// assimp mistakes rotations for shifts.

#include <string>

#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// `text` is the whole file, which may be a zip archive of one AMF. Throws ImportError with the
/// cause.
[[nodiscard]] ImportedMesh read_amf(std::string text);

}  // namespace tactree::builder
