#pragma once
// Finds what assimp leaves out of an X3D file without a word, and the unit that it ignores.

#include <string>

#include "mesh_import/scene_notes.hpp"

namespace tactree::builder {

/// Throws ImportError if the file has shapes that are not read. A malformed document has no notes.
[[nodiscard]] SceneNotes check_x3d(std::string text);

}  // namespace tactree::builder
