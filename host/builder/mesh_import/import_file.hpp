#pragma once
// Reads one mesh file and writes the result to a file descriptor, in the format of wire.hpp.

#include "mesh_import/wire.hpp"

namespace tactree::builder {

/// Reads the mesh `file` as a file with the extension `hint` (e.g. "glb") and writes its points and
/// triangles to `output`, or kRefused with the cause. Returns true if a mesh was written. May crash
/// or throw std::bad_alloc on a damaged file, so call it in a process with limits.
[[nodiscard]] bool import_file(const char* file, const char* hint, int output);

/// Writes a header with a status and a text of at most kMaxWireText bytes. Allocates nothing, so
/// that it also works when memory is exhausted.
void write_status(int output, WireStatus status, const char* text);

}  // namespace tactree::builder
