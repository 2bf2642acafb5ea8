#pragma once
// Finds what assimp leaves out of a COLLADA file without a word.

#include <string>

#include "mesh_import/scene_notes.hpp"

namespace tactree::builder {

/// A malformed document has no notes. Throws ImportError if it is too large, or if
/// its parts are in other files.
[[nodiscard]] SceneNotes check_collada(std::string text);

}  // namespace tactree::builder
