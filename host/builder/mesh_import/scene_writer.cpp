#include "mesh_import/scene_writer.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "mesh_import/wire.hpp"

namespace tactree::builder {
namespace {

Eigen::Vector3d to_eigen(const aiVector3D& vector) {
  return {static_cast<double>(vector.x), static_cast<double>(vector.y),
          static_cast<double>(vector.z)};
}

/// Normals transform by the inverse transpose, also for a reflection.
Eigen::Matrix3d normal_matrix(const PointTransform& transform) {
  return transform.leftCols<3>().inverse().transpose();
}

/// An FBX may move the points of a node before its transform; the library has nodes for this.
bool has_geometric_offset(const aiNode* node) {
  for (; node != nullptr; node = node->mParent) {
    const std::string_view name = node->mName.C_Str();
    if (name.ends_with("$_GeometricTranslation") || name.ends_with("$_GeometricRotation") ||
        name.ends_with("$_GeometricScaling")) {
      return true;
    }
  }
  return false;
}

}  // namespace

SceneWriter::SceneWriter(const aiScene& scene, const FileUnit& unit, bool turned,
                         std::string warning, std::FILE* to)
    : scene_(scene), unit_(unit), turned_(turned), warning_(std::move(warning)), to_(to) {}

void SceneWriter::place_meshes() {
  struct Node {
    const aiNode* node;
    Eigen::Matrix4d parent;
  };
  Eigen::Matrix4d frame = Eigen::Matrix4d::Identity();
  if (turned_) frame.topLeftCorner<3, 3>() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  std::vector<Node> open;
  if (scene_.mRootNode != nullptr) open.push_back({scene_.mRootNode, frame});
  while (!open.empty()) {
    const Node current = open.back();
    open.pop_back();
    const Eigen::Matrix4d transform = current.parent * to_eigen(current.node->mTransformation);
    nodes_.add(current.node->mName.C_Str(), transform);
    for (unsigned i = 0; i < current.node->mNumMeshes; ++i) {
      const unsigned index = current.node->mMeshes[i];
      if (index >= scene_.mNumMeshes) continue;
      placed_.push_back({scene_.mMeshes[index], transform, {}});
      moved_skins_ = moved_skins_ ||
                     (scene_.mMeshes[index]->mNumBones > 0 && has_geometric_offset(current.node));
    }
    for (unsigned i = current.node->mNumChildren; i > 0; --i) {
      open.push_back({current.node->mChildren[i - 1], transform});
    }
  }
}

void SceneWriter::pose_meshes() {
  std::string unknown_bone;
  for (Placed& placed : placed_) {
    placed.skin = skin_of(*placed.mesh, nodes_, placed.transform, unknown_bone);
  }
  if (moved_skins_) {
    warning_ += (warning_.empty() ? "" : " ") +
                std::string(
                    "A skin has a geometric transform, which is not applied: it may lie at "
                    "another place. Apply the pose in Blender and save the file as PLY.");
  }
  if (!unknown_bone.empty()) {
    warning_ += (warning_.empty() ? "" : " ") + std::string("The place of the bone \"") +
                unknown_bone.substr(0, 40) +
                "\" is not known: a mesh is read without its bones, perhaps at another place. "
                "Apply the pose in Blender and save the file as PLY.";
  }
}

void SceneWriter::count() {
  for (const Placed& placed : placed_) {
    const aiMesh& mesh = *placed.mesh;
    points_ += mesh.mNumVertices;
    normals_ = normals_ && mesh.HasNormals();
    colours_ = colours_ && mesh.HasVertexColors(0);
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      if (mesh.mFaces[i].mNumIndices == 3) ++triangles_;
    }
  }
}

bool SceneWriter::write() {
  place_meshes();
  pose_meshes();
  count();
  if (points_ == 0) return false;
  WireHeader header;
  header.flags = (normals_ ? kHasNormals : 0) | (colours_ ? kHasColours : 0);
  header.points = points_;
  header.triangles = triangles_;
  header.unit_m = unit_.metres;
  header.text_bytes =
      static_cast<std::uint32_t>(std::min<std::size_t>(warning_.size(), kMaxWireText));
  put(&header, sizeof header);
  put(warning_.data(), header.text_bytes);
  for (const Placed& placed : placed_) write_points(placed);
  std::uint64_t first_point = 0;
  for (const Placed& placed : placed_) {
    write_triangles(placed, first_point);
    first_point += placed.mesh->mNumVertices;
  }
  put(kWireEnd.data(), kWireEnd.size());
  return !failed_ && std::fflush(to_) == 0;
}

void SceneWriter::write_points(const Placed& placed) {
  const aiMesh& mesh = *placed.mesh;
  const double to_units = unit_.scene_scaled ? 1.0 / unit_.metres : 1.0;
  PointTransform transform = placed.transform.topRows<3>();
  Eigen::Matrix3d for_normals = normal_matrix(transform);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    if (!placed.skin.empty()) {
      transform = placed.skin[i];
      if (normals_) for_normals = normal_matrix(transform);
    }
    const Eigen::Vector3d position =
        to_units * (transform * to_eigen(mesh.mVertices[i]).homogeneous());
    put(position.data(), sizeof(double) * 3);
    if (normals_) {
      const Eigen::Vector3f normal =
          (for_normals * to_eigen(mesh.mNormals[i])).normalized().cast<float>();
      put(normal.data(), sizeof(float) * 3);
    }
    if (colours_) {
      const aiColor4D& colour = mesh.mColors[0][i];
      const std::array<std::uint8_t, 3> bytes = {colour_byte(static_cast<double>(colour.r)),
                                                 colour_byte(static_cast<double>(colour.g)),
                                                 colour_byte(static_cast<double>(colour.b))};
      put(bytes.data(), bytes.size());
    }
  }
}

void SceneWriter::write_triangles(const Placed& placed, std::uint64_t first_point) {
  const aiMesh& mesh = *placed.mesh;
  const auto is_mirrored = [](const auto& linear) { return linear.determinant() < 0; };
  bool mirrored = is_mirrored(placed.transform.topLeftCorner<3, 3>());
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    if (mesh.mFaces[i].mNumIndices != 3) continue;
    const unsigned* corners = mesh.mFaces[i].mIndices;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle[k] = static_cast<std::uint32_t>(first_point + corners[k]);
    }
    if (!placed.skin.empty()) mirrored = is_mirrored(placed.skin[corners[0]].leftCols<3>());
    // A reflection reverses the winding, so two vertices are swapped.
    if (mirrored) std::swap(triangle[1], triangle[2]);
    put(triangle.data(), sizeof triangle);
  }
}

void SceneWriter::put(const void* data, std::size_t size) {
  if (std::fwrite(data, 1, size, to_) != size) failed_ = true;
}

}  // namespace tactree::builder
