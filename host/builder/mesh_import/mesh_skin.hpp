#pragma once
// The pose of a mesh with bones, as the nodes of the scene place them.

#include <assimp/mesh.h>

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace tactree::builder {

/// Transforms of the nodes of a scene to its root, by name.
class NodePlaces {
 public:
  void add(const std::string& name, const Eigen::Matrix4d& transform);

  /// Null if there is no node of the name, or several at different places.
  [[nodiscard]] const Eigen::Matrix4d* find(const std::string& name) const;

 private:
  struct Place {
    Eigen::Matrix4d transform;
    bool ambiguous = false;
  };
  std::map<std::string, Place> places_;
};

using PointTransform = Eigen::Matrix<double, 3, 4>;

[[nodiscard]] Eigen::Matrix4d to_eigen(const aiMatrix4x4& matrix);

/// The transform of each point: the weighted sum of those of its bones, or `node` if it has none.
/// Empty if the mesh has no bones, or if the place of a bone is unknown, whose name is then put
/// into `unknown_bone`.
[[nodiscard]] std::vector<PointTransform> skin_of(const aiMesh& mesh, const NodePlaces& nodes,
                                                  const Eigen::Matrix4d& node,
                                                  std::string& unknown_bone);

}  // namespace tactree::builder
