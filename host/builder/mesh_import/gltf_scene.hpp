#pragma once
// Reads a glTF 2 file as one mesh, in the pose that the file states: its nodes, meshes, quantized
// positions, morph targets and skins.

#include "mesh_import/contained_files.hpp"
#include "mesh_import/gltf_file.hpp"
#include "mesh_import/imported_mesh.hpp"

namespace tactree::builder {

/// True if meshes are compressed with Draco (KHR_draco_mesh_compression), which the library
/// decodes. Throws ImportError if the library cannot read the file correctly, because it has skins
/// or requires other extensions.
[[nodiscard]] bool is_draco_gltf(const GltfFile& file);

/// Throws ImportError with the cause, such as a required extension that is not supported.
[[nodiscard]] ImportedMesh read_gltf(GltfFile& file);

}  // namespace tactree::builder
