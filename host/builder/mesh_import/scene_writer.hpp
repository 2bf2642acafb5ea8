#pragma once
// Writes an imported scene in the format of wire.hpp: all meshes, with the transforms of their
// nodes applied, as one list of points and one list of triangles.

#include <assimp/scene.h>

#include <Eigen/Core>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "mesh_import/mesh_skin.hpp"
#include "mesh_import/unit_of_file.hpp"

namespace tactree::builder {

class SceneWriter {
 public:
  /// The positions are written in units of the file. `turned` means that the library has turned the
  /// z axis of the file to its y axis; the writer turns it back.
  /// `warning` has sentences about the file, or is empty.
  SceneWriter(const aiScene& scene, const FileUnit& unit, bool turned, std::string warning,
              std::FILE* to);

  /// Returns false if the scene has no point or writing fails.
  [[nodiscard]] bool write();

 private:
  /// An instance of a mesh.
  struct Placed {
    const aiMesh* mesh;
    Eigen::Matrix4d transform;
    std::vector<PointTransform> skin;  // empty without bones
  };

  void place_meshes();
  void pose_meshes();
  void count();
  void write_points(const Placed& placed);
  void write_triangles(const Placed& placed, std::uint64_t first_point);
  void put(const void* data, std::size_t size);

  const aiScene& scene_;
  FileUnit unit_;
  bool turned_;
  std::string warning_;
  std::FILE* to_;
  bool failed_ = false;
  bool moved_skins_ = false;  // by geometric transforms of an FBX
  NodePlaces nodes_;
  std::vector<Placed> placed_;
  std::uint64_t points_ = 0;
  std::uint64_t triangles_ = 0;
  bool normals_ = true;
  bool colours_ = true;
};

}  // namespace tactree::builder
