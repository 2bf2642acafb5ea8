#pragma once
// Reads a 3MF file: the objects that its build references, with their components, also components
// in separate model parts (the production extension).

#include <string_view>

#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// `bytes` is the whole file. Throws ImportError with the cause, such as a required extension that
/// is not supported.
[[nodiscard]] ImportedMesh read_3mf(std::string_view bytes);

}  // namespace tactree::builder
