#pragma once
// One model part of a 3MF file: its objects, and the items of its build.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_import/mesh_extractor.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {

/// A reference to an object, from another object or from the build.
struct ModelComponent {
  std::string part;  // path of its model part
  std::string object;
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  bool printed = true;
};

struct ModelObject {
  std::string type;    // "model" or empty for the body
  std::string unread;  // element of a shape that is not a mesh
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<ModelComponent> components;
};

struct ModelPart {
  double unit_m = 1e-3;
  std::map<std::string, ModelObject, std::less<>> objects;
  std::vector<ModelComponent> build;
};

/// Path of a part without the leading slash.
[[nodiscard]] std::string part_path(std::string_view path);

/// `blocks` are those of a MeshExtractor, or null if the document has all elements. Throws
/// ImportError.
[[nodiscard]] ModelPart read_model_part(const XmlDocument& document, const std::string& part,
                                        std::vector<MeshBlock>* blocks);

}  // namespace tactree::builder
