#pragma once
// The nodes of a glTF scene: which of them it shows, and where they place their meshes.

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "mesh_import/gltf_file.hpp"

namespace tactree::builder {

/// A node that places its mesh several times.
inline constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

/// Its functions throw ImportError, or the exceptions of the JSON if it lacks the structure of
/// glTF.
class GltfNodes {
 public:
  /// `file` must outlive this object. Throws if the nodes do not form trees.
  explicit GltfNodes(GltfFile& file);

  /// The roots of the scene and the nodes below them, each before its children.
  [[nodiscard]] const std::vector<std::size_t>& shown() const { return shown_; }
  /// Number of hidden nodes (KHR_node_visibility); those below them are not counted.
  [[nodiscard]] std::size_t hidden() const { return hidden_; }

  /// Transforms from the frame of the mesh to that of the scene: one, or one per instance.
  [[nodiscard]] std::vector<Eigen::Matrix4d> places(std::size_t number) const;
  /// Those of the joints of its skin; empty without a skin.
  [[nodiscard]] std::vector<Eigen::Matrix4d> joints(std::size_t number) const;

 private:
  void find_parents();
  void place(std::size_t number);
  void find_shown();

  GltfFile& file_;
  std::vector<std::size_t> parents_;
  std::vector<std::optional<Eigen::Matrix4d>> worlds_;
  std::vector<std::size_t> shown_;
  std::size_t hidden_ = 0;
};

}  // namespace tactree::builder
