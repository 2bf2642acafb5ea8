#include "mesh_import/mesh_skin.hpp"

namespace tactree::builder {

Eigen::Matrix4d to_eigen(const aiMatrix4x4& matrix) {
  Eigen::Matrix4d result;
  for (unsigned row = 0; row < 4; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      result(row, column) = static_cast<double>(matrix[row][column]);
    }
  }
  return result;
}

void NodePlaces::add(const std::string& name, const Eigen::Matrix4d& transform) {
  const auto [place, added] = places_.emplace(name, Place{transform});
  if (!added && place->second.transform != transform) place->second.ambiguous = true;
}

const Eigen::Matrix4d* NodePlaces::find(const std::string& name) const {
  const auto found = places_.find(name);
  const bool known = found != places_.end() && !found->second.ambiguous;
  return known ? &found->second.transform : nullptr;
}

std::vector<PointTransform> skin_of(const aiMesh& mesh, const NodePlaces& nodes,
                                    const Eigen::Matrix4d& node, std::string& unknown_bone) {
  if (mesh.mNumBones == 0) return {};
  std::vector<PointTransform> skin(mesh.mNumVertices, PointTransform::Zero());
  std::vector<double> sums(mesh.mNumVertices, 0.0);
  for (unsigned i = 0; i < mesh.mNumBones; ++i) {
    const aiBone& bone = *mesh.mBones[i];
    if (bone.mNumWeights == 0) continue;
    const Eigen::Matrix4d* const place = nodes.find(bone.mName.C_Str());
    if (place == nullptr) {
      unknown_bone = bone.mName.C_Str();
      return {};
    }
    const PointTransform transform = (*place * to_eigen(bone.mOffsetMatrix)).topRows<3>();
    for (unsigned k = 0; k < bone.mNumWeights; ++k) {
      const unsigned vertex = bone.mWeights[k].mVertexId;
      const auto weight = static_cast<double>(bone.mWeights[k].mWeight);
      if (vertex >= mesh.mNumVertices || !(weight > 0.0)) continue;
      skin[vertex] += weight * transform;
      sums[vertex] += weight;
    }
  }
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    if (sums[i] > 0.0) {
      skin[i] /= sums[i];
    } else {
      skin[i] = node.topRows<3>();
    }
  }
  return skin;
}

}  // namespace tactree::builder
