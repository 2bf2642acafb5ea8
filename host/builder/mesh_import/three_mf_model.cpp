#include "mesh_import/three_mf_model.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace tactree::builder {
namespace {

/// Parses twelve numbers, the rows of a matrix that multiplies row vectors.
Eigen::Affine3d transform_of(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  Eigen::Index count = 0;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    if (text.empty()) break;
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    const std::optional<double> number = number_of(word);
    if (!number || !std::isfinite(*number)) throw not_a(word, "number of a transform");
    if (count < 12) transform.matrix()(count % 3, count / 3) = *number;
    ++count;
    text.remove_prefix(word.size());
  }
  if (count != 0 && count != 12) {
    throw ImportError("a transform has " + std::to_string(count) + " numbers, not 12");
  }
  return transform;
}

/// Refuses extensions that the model requires and this reader does not support.
void check_extensions(pugi::xml_node model) {
  constexpr std::string_view kSupported[] = {"/production/", "/material/", "/trianglesets/",
                                             "/core/"};
  std::string_view required = attribute_of(model, "requiredextensions");
  while (!required.empty()) {
    const std::size_t end = std::min(required.find(' '), required.size());
    const std::string prefix = "xmlns:" + std::string(required.substr(0, end));
    required.remove_prefix(std::min(end + 1, required.size()));
    for (const pugi::xml_attribute attribute : model.attributes()) {
      const std::string_view space = attribute.value();
      const bool known = std::any_of(
          std::begin(kSupported), std::end(kSupported),
          [&](std::string_view part) { return space.find(part) != std::string_view::npos; });
      if (attribute.name() == prefix && !known) {
        throw ImportError("it requires the extension " + std::string(space.substr(0, 100)) +
                          ", which is not supported");
      }
    }
  }
}

/// The type of an object, as the core specification names it. Cura has a type "model" for all, and
/// marks the others by its settings.
std::string_view type_of(pugi::xml_node object) {
  constexpr std::pair<std::string_view, std::string_view> kSettings[] = {
      {"cura:support_mesh", "support"},
      {"cura:anti_overhang_mesh", "support blocker"},
      {"cura:infill_mesh", "modifier"},
      {"cura:cutting_mesh", "modifier"}};
  std::string_view type = attribute_of(object, "type");
  for_children(child_of(object, "metadatagroup"), "metadata", [&](pugi::xml_node metadata) {
    const std::string_view name = metadata.attribute("name").value();
    for (const auto& [setting, meaning] : kSettings) {
      if (name == setting && std::string_view(metadata.child_value()) == "True") type = meaning;
    }
  });
  return type;
}

/// Reads one model part.
class ModelReader {
 public:
  /// `blocks` are those of a MeshExtractor, or null if the document has all elements.
  ModelReader(const XmlDocument& document, std::string part, std::vector<MeshBlock>* blocks)
      : root_(child_of(document.root(), "model")), part_(std::move(part)), blocks_(blocks) {}

  ModelPart read() {
    if (root_.empty()) {
      throw ImportError("it has no element \"model\"");
    }
    check_extensions(root_);
    model_.unit_m = metres_of_print_unit(attribute_of(root_, "unit"));
    for_children(root_, "resources", [&](pugi::xml_node resources) {
      for_children(resources, "object", [&](pugi::xml_node object) { read_object(object); });
    });
    for_children(root_, "build", [&](pugi::xml_node build) {
      for_children(build, "item",
                   [&](pugi::xml_node item) { model_.build.push_back(component(item)); });
    });
    return std::move(model_);
  }

 private:
  void read_object(pugi::xml_node element) {
    const std::string id(attribute_of(element, "id"));
    const auto [place, added] = model_.objects.try_emplace(id);
    if (!added) throw ImportError("it has two objects with the id \"" + id.substr(0, 40) + "\"");
    ModelObject& object = place->second;
    object.type = type_of(element);
    find_unread(element, object);
    bool meshed = false;
    for_children(element, "mesh", [&](pugi::xml_node mesh) {
      if (meshed) throw ImportError("its object \"" + id.substr(0, 40) + "\" has two meshes");
      meshed = true;
      read_mesh(mesh, object);
    });
    for_children(element, "components", [&](pugi::xml_node components) {
      for_children(components, "component",
                   [&](pugi::xml_node inner) { object.components.push_back(component(inner)); });
    });
  }

  /// Shapes of other extensions.
  static void find_unread(pugi::xml_node element, ModelObject& object) {
    constexpr std::string_view kShapes[] = {"beamlattice", "booleanshape", "displacementmesh",
                                            "levelset"};
    for (const pugi::xml_node parent : {element, child_of(element, "mesh")}) {
      for (const pugi::xml_node child : parent.children()) {
        const auto* const shape =
            std::find(std::begin(kShapes), std::end(kShapes), local_name(child));
        if (shape != std::end(kShapes)) object.unread = *shape;
      }
    }
  }

  void read_mesh(pugi::xml_node mesh, ModelObject& object) const {
    for_children(mesh, "vertices", [&](pugi::xml_node vertices) {
      if (MeshBlock* const block = block_of(vertices)) append(block->vertices, object.vertices);
      for_children(vertices, "vertex", [&](pugi::xml_node vertex) {
        const std::size_t index = object.vertices.size();
        object.vertices.emplace_back(coordinate(vertex, "x", index), coordinate(vertex, "y", index),
                                     coordinate(vertex, "z", index));
      });
    });
    for_children(mesh, "triangles", [&](pugi::xml_node triangles) {
      if (MeshBlock* const block = block_of(triangles)) append(block->triangles, object.triangles);
      for_children(triangles, "triangle", [&](pugi::xml_node triangle) {
        object.triangles.push_back({index_of(attribute_of(triangle, "v1")),
                                    index_of(attribute_of(triangle, "v2")),
                                    index_of(attribute_of(triangle, "v3"))});
      });
    });
  }

  /// The block whose index is the content of the element, or null.
  [[nodiscard]] MeshBlock* block_of(pugi::xml_node element) const {
    if (blocks_ == nullptr || element.child_value()[0] == '\0') return nullptr;
    const std::uint32_t index = index_of(element.child_value());
    return index < blocks_->size() ? &(*blocks_)[index] : nullptr;
  }

  template <typename Entry>
  static void append(std::vector<Entry>& from, std::vector<Entry>& to) {
    if (to.empty()) {
      to = std::move(from);
    } else {
      to.insert(to.end(), from.begin(), from.end());
    }
    from = {};
  }

  static double coordinate(pugi::xml_node vertex, const char* axis, std::size_t index) {
    const std::string_view text = attribute_of(vertex, axis);
    const std::optional<double> number = number_of(text);
    if (!number) throw not_a(text, "coordinate of vertex " + std::to_string(index));
    return *number;
  }

  [[nodiscard]] ModelComponent component(pugi::xml_node element) const {
    const std::string_view path = attribute_of(element, "path");
    const std::string_view printed = attribute_of(element, "printable");
    return {path.empty() ? part_ : part_path(path), std::string(attribute_of(element, "objectid")),
            transform_of(attribute_of(element, "transform")), printed != "0" && printed != "false"};
  }

  pugi::xml_node root_;
  std::string part_;
  std::vector<MeshBlock>* blocks_;
  ModelPart model_;
};

}  // namespace

std::string part_path(std::string_view path) {
  std::string name(path);
  if (name.starts_with('/')) {
    name.erase(0, 1);
  }
  return name;
}

ModelPart read_model_part(const XmlDocument& document, const std::string& part,
                          std::vector<MeshBlock>* blocks) {
  try {
    return ModelReader(document, part, blocks).read();
  } catch (const ImportError& error) {
    throw ImportError("its part \"" + part + "\": " + error.what());
  }
}

}  // namespace tactree::builder
