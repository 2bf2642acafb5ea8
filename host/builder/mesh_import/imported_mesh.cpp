#include "mesh_import/imported_mesh.hpp"

#include <algorithm>

#include "mesh_import/wire.hpp"

namespace tactree::builder {

bool write_mesh(const ImportedMesh& mesh, std::FILE* to) {
  bool failed = false;
  const auto put = [&](const void* data, std::size_t size) {
    failed = failed || std::fwrite(data, 1, size, to) != size;
  };
  WireHeader header;
  const bool normals = !mesh.normals.empty();
  const bool colours = !mesh.colours.empty();
  header.flags = (normals ? kHasNormals : 0) | (colours ? kHasColours : 0);
  header.points = mesh.positions.size();
  header.triangles = mesh.triangles.size();
  header.text_bytes =
      static_cast<std::uint32_t>(std::min<std::size_t>(mesh.warning.size(), kMaxWireText));
  header.unit_m = mesh.unit_m;
  put(&header, sizeof header);
  put(mesh.warning.data(), header.text_bytes);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    put(mesh.positions[i].data(), 3 * sizeof(double));
    if (normals) {
      put(mesh.normals[i].data(), 3 * sizeof(float));
    }
    if (colours) {
      put(mesh.colours[i].data(), 3);
    }
  }
  for (const auto& triangle : mesh.triangles) {
    put(triangle.data(), sizeof triangle);
  }
  put(kWireEnd.data(), kWireEnd.size());
  return !failed && std::fflush(to) == 0;
}

}  // namespace tactree::builder
