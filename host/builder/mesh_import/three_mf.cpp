#include "mesh_import/three_mf.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh_import/mesh_extractor.hpp"
#include "mesh_import/xml_document.hpp"
#include "mesh_import/zip_archive.hpp"

namespace tactree::builder {
namespace {

using Transform = Eigen::Affine3d;

constexpr unsigned kMaxDepth = 32;                // nesting of components
constexpr std::size_t kMaxInstances = 1'000'000;  // of objects
// Of a document without the meshes that MeshExtractor takes. Larger ones would exceed the memory
// limit of the import process.
constexpr XmlLimits kXmlLimits{std::size_t{1} << 30, 16'000'000};
constexpr const char* kRelations = "_rels/.rels";

/// A reference to an object, from another object or from the build.
struct Component {
  std::string part;  // path of its model part
  std::string object;
  Transform transform = Transform::Identity();
};

struct Object {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Component> components;
};

struct Model {
  double unit_m = 1e-3;
  std::map<std::string, Object, std::less<>> objects;
  std::vector<Component> build;
};

std::string canonical(std::string_view path) {
  std::string name(path);
  if (name.starts_with('/')) {
    name.erase(0, 1);
  }
  return name;
}

/// Parses twelve numbers, the rows of a matrix that multiplies row vectors.
Transform transform_of(std::string_view text) {
  Transform transform = Transform::Identity();
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return transform;
  }
  for (Eigen::Index i = 0; i < 12; ++i) {
    const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(" \t\r\n"), text.size());
    transform.matrix()(i % 3, i / 3) = number_of(text.substr(0, end), "number of a transform");
    text.remove_prefix(end);
  }
  return transform;
}

double unit_of(std::string_view name) {
  struct Unit {
    std::string_view name;
    double metres;
  };
  constexpr Unit kUnits[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2},
                             {"inch", 0.0254}, {"foot", 0.3048},     {"meter", 1.0}};
  for (const Unit& unit : kUnits) {
    if (unit.name == name) {
      return unit.metres;
    }
  }
  if (!name.empty()) {
    throw ImportError("its unit \"" + std::string(name.substr(0, 20)) + "\" is not known");
  }
  return 1e-3;
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

/// Reads one model part.
class ModelReader {
 public:
  /// `blocks` are those of a MeshExtractor, or null if the document has all elements.
  ModelReader(const XmlDocument& document, std::string part, std::vector<MeshBlock>* blocks)
      : root_(child_of(document.root(), "model")), part_(std::move(part)), blocks_(blocks) {}

  Model read() {
    if (root_.empty()) {
      throw ImportError("its part \"" + part_ + "\" has no element \"model\"");
    }
    check_extensions(root_);
    model_.unit_m = unit_of(attribute_of(root_, "unit"));
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
    Object& object = model_.objects[std::string(attribute_of(element, "id"))];
    for_children(element, "mesh", [&](pugi::xml_node mesh) { read_mesh(mesh, object); });
    for_children(element, "components", [&](pugi::xml_node components) {
      for_children(components, "component",
                   [&](pugi::xml_node inner) { object.components.push_back(component(inner)); });
    });
  }

  void read_mesh(pugi::xml_node mesh, Object& object) const {
    for_children(mesh, "vertices", [&](pugi::xml_node vertices) {
      if (MeshBlock* const block = block_of(vertices)) append(block->vertices, object.vertices);
      for_children(vertices, "vertex", [&](pugi::xml_node vertex) {
        object.vertices.emplace_back(coordinate(vertex, "x"), coordinate(vertex, "y"),
                                     coordinate(vertex, "z"));
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

  static double coordinate(pugi::xml_node vertex, const char* axis) {
    return number_of(attribute_of(vertex, axis), "coordinate of a vertex");
  }

  [[nodiscard]] Component component(pugi::xml_node element) const {
    const std::string_view path = attribute_of(element, "path");
    return {path.empty() ? part_ : canonical(path), std::string(attribute_of(element, "objectid")),
            transform_of(attribute_of(element, "transform"))};
  }

  pugi::xml_node root_;
  std::string part_;
  std::vector<MeshBlock>* blocks_;
  Model model_;
};

class Assembly {
 public:
  explicit Assembly(std::string_view bytes) : archive_(bytes) {}

  ImportedMesh read() {
    const Model& root = model(root_part());
    mesh_.unit_m = root.unit_m;
    if (root.build.empty()) {
      throw ImportError("its build refers to no object");
    }
    for (const Component& item : root.build) {
      add(item, Transform::Identity(), 0);
    }
    if (mesh_.positions.empty()) {
      throw ImportError("it contains no points and no faces");
    }
    if (bad_triangles_ > 0) {
      mesh_.warning = std::to_string(bad_triangles_) +
                      " triangles were dropped: they refer to points that the file does not have.";
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] XmlDocument parsed(const std::string& part) const {
    try {
      return {archive_.read(part), kXmlLimits};
    } catch (const XmlTooLarge& error) {
      throw ImportError("its part \"" + part + "\" is too large: " + error.what());
    } catch (const XmlError& error) {
      throw ImportError("its part \"" + part + "\" is damaged or was cut off: " + error.what());
    }
  }

  [[nodiscard]] std::string root_part() const {
    if (archive_.contains(kRelations)) {
      const XmlDocument document = parsed(kRelations);
      std::string target;
      for_children(child_of(document.root(), "Relationships"), "Relationship",
                   [&](pugi::xml_node relation) {
                     if (target.empty() && attribute_of(relation, "Type").ends_with("/3dmodel")) {
                       target = canonical(attribute_of(relation, "Target"));
                     }
                   });
      if (!target.empty()) {
        return target;
      }
    }
    const std::string first = archive_.first_with_ending(".model");
    if (first.empty()) {
      throw ImportError("it has no part with a model");
    }
    return first;
  }

  const Model& model(const std::string& part) {
    const auto found = models_.find(part);
    if (found != models_.end()) {
      return found->second;
    }
    return models_.emplace(part, read_part(part)).first->second;
  }

  [[nodiscard]] Model read_part(const std::string& part) const {
    MeshExtractor extractor;
    const bool extracted = archive_.unpack(part, [&](std::string_view bytes) {
      return extractor.feed(bytes);
    }) && extractor.is_complete();
    if (extracted && !extractor.error().empty()) throw ImportError(extractor.error());
    if (extracted) {
      try {
        const XmlDocument document(extractor.take_rest(), kXmlLimits);
        return ModelReader(document, part, &extractor.blocks()).read();
      } catch (const XmlError&) {
        // The whole document is parsed below, so that the message states its position.
      }
    }
    const XmlDocument document = parsed(part);
    return ModelReader(document, part, nullptr).read();
  }

  void add(const Component& component, const Transform& outer, unsigned depth) {
    const Model& from = model(component.part);
    const auto found = from.objects.find(component.object);
    if (found == from.objects.end()) {
      throw ImportError("its part \"" + component.part + "\" has no object \"" +
                        component.object.substr(0, 40) + "\"");
    }
    if (depth > kMaxDepth || ++instances_ > kMaxInstances) {
      throw ImportError("its objects are nested too deeply or too often");
    }
    const Transform transform = outer * component.transform;
    const Object& object = found->second;
    // If a part has another unit, this unit applies to its vertices.
    add_mesh(object, transform, from.unit_m / mesh_.unit_m);
    for (const Component& inner : object.components) {
      add(inner, transform, depth + 1);
    }
  }

  void add_mesh(const Object& object, const Transform& transform, double scale) {
    if (mesh_.positions.size() + object.vertices.size() >=
        std::numeric_limits<std::uint32_t>::max()) {
      throw ImportError("it has more than 2^32 points");
    }
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    make_room(mesh_.positions, object.vertices.size());
    make_room(mesh_.triangles, object.triangles.size());
    for (const Eigen::Vector3d& vertex : object.vertices) {
      mesh_.positions.push_back(transform * (scale * vertex));
    }
    // A reflection reverses the winding, so two vertices are swapped.
    const bool mirrored = transform.linear().determinant() < 0;
    for (std::array<std::uint32_t, 3> triangle : object.triangles) {
      if (*std::max_element(triangle.begin(), triangle.end()) >= object.vertices.size()) {
        ++bad_triangles_;
        continue;
      }
      if (mirrored) std::swap(triangle[1], triangle[2]);
      for (std::uint32_t& corner : triangle) corner += first;
      mesh_.triangles.push_back(triangle);
    }
  }

  /// Grows no further than needed, because large meshes approach the memory limit.
  template <typename Entry>
  static void make_room(std::vector<Entry>& list, std::size_t more) {
    const std::size_t needed = list.size() + more;
    if (needed > list.capacity()) list.reserve(std::max(needed, list.size() + list.size() / 2));
  }

  ZipArchive archive_;
  std::map<std::string, Model, std::less<>> models_;
  ImportedMesh mesh_;
  std::size_t instances_ = 0;
  std::uint64_t bad_triangles_ = 0;
};

}  // namespace

ImportedMesh read_3mf(std::string_view bytes) { return Assembly(bytes).read(); }

}  // namespace tactree::builder
