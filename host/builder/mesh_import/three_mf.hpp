#pragma once
// Reads a 3MF file: the objects that its build names, with their components, also those in model
// parts of their own (the production extension).

#include <string_view>

#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// bytes: of the whole file. Throws ImportError with the cause, such as a required extension that
/// is not supported.
[[nodiscard]] ImportedMesh read_3mf(std::string_view bytes);

}  // namespace tactree::builder
