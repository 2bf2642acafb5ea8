#pragma once
// Writes an imported scene in the form of import_wire.hpp: all meshes with the transforms of their
// nodes applied, as one list of points and one of triangles.

#include <assimp/scene.h>

#include <Eigen/Core>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace tactree::import_mesh {

class SceneWriter {
 public:
  SceneWriter(const aiScene& scene, std::FILE* to);

  /// False when there is no point to write, or the output fails.
  [[nodiscard]] bool write();

 private:
  /// A mesh as one node shows it.
  struct Placed {
    const aiMesh* mesh;
    Eigen::Matrix4d transform;
  };

  void place_meshes();
  void count();
  void write_points(const Placed& placed);
  void write_triangles(const Placed& placed, std::uint64_t first_point);
  void put(const void* data, std::size_t size);

  const aiScene& scene_;
  std::FILE* to_;
  bool failed_ = false;
  std::vector<Placed> placed_;
  std::uint64_t points_ = 0;
  std::uint64_t triangles_ = 0;
  bool normals_ = true;
  bool colours_ = true;
};

}  // namespace tactree::import_mesh
