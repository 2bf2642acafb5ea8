#include "mesh_import/three_mf.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh_import/xml_tags.hpp"
#include "mesh_import/zip_archive.hpp"

namespace tactree::builder {
namespace {

using Transform = Eigen::Affine3d;

constexpr unsigned kMaxDepth = 32;                // of components in components
constexpr std::size_t kMaxInstances = 1'000'000;  // of objects
constexpr const char* kRelations = "_rels/.rels";

/// An object in an object, or in the build.
struct Component {
  std::string part;  // path of its model
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
  std::string name = without_entities(path);
  if (name.starts_with('/')) {
    name.erase(0, 1);
  }
  return name;
}

double number_of(std::string_view text, const char* what) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '+')) {
    text.remove_prefix(1);
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end == text.data()) {
    throw ImportError(std::string("\"") + std::string(text.substr(0, 20)) + "\" is not a " + what);
  }
  return value;
}

/// An index; what is none becomes the highest, so that its triangle is dropped.
std::uint32_t index_of(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  (void)end;
  return error == std::errc{} ? value : std::numeric_limits<std::uint32_t>::max();
}

/// Twelve numbers: the rows of a matrix that multiplies row vectors.
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

/// Refuses extensions that the model requires and that change its shape.
void check_extensions(const XmlTags& model) {
  constexpr std::string_view kSupported[] = {"/production/", "/material/", "/trianglesets/",
                                             "/core/"};
  std::string_view required = model.attribute("requiredextensions");
  while (!required.empty()) {
    const std::size_t end = std::min(required.find(' '), required.size());
    const std::string prefix = "xmlns:" + std::string(required.substr(0, end));
    required.remove_prefix(std::min(end + 1, required.size()));
    for (const auto& [name, value] : model.attributes()) {
      const std::string_view space = value;
      const bool known = std::any_of(
          std::begin(kSupported), std::end(kSupported),
          [&](std::string_view part) { return space.find(part) != std::string_view::npos; });
      if (name == prefix && !known) {
        throw ImportError("it requires the extension " + std::string(value.substr(0, 100)) +
                          ", which is not supported");
      }
    }
  }
}

/// Reads one model part.
class ModelReader {
 public:
  ModelReader(std::string_view text, std::string part) : tags_(text), part_(std::move(part)) {}

  Model read() {
    while (tags_.next()) {
      if (tags_.closes()) {
        if (tags_.name() == "object") object_ = nullptr;
      } else {
        read_tag();
      }
    }
    if (tags_.cut_off() || !found_) {
      throw ImportError("its part \"" + part_ + "\" is damaged or was cut off");
    }
    return std::move(model_);
  }

 private:
  void read_tag() {
    const std::string_view name = tags_.name();
    if (name == "model") {
      found_ = true;
      check_extensions(tags_);
      model_.unit_m = unit_of(tags_.attribute("unit"));
    } else if (name == "object") {
      object_ = &model_.objects[without_entities(tags_.attribute("id"))];
    } else if (name == "item") {
      model_.build.push_back(component());
    } else if (object_ != nullptr) {
      read_part(name);
    }
  }

  void read_part(std::string_view name) {
    if (name == "vertex") {
      object_->vertices.emplace_back(coordinate("x"), coordinate("y"), coordinate("z"));
    } else if (name == "triangle") {
      object_->triangles.push_back({index_of(tags_.attribute("v1")),
                                    index_of(tags_.attribute("v2")),
                                    index_of(tags_.attribute("v3"))});
    } else if (name == "component") {
      object_->components.push_back(component());
    }
  }

  [[nodiscard]] double coordinate(const char* axis) const {
    return number_of(tags_.attribute(axis), "coordinate of a vertex");
  }

  [[nodiscard]] Component component() const {
    const std::string_view path = tags_.attribute("path");
    return {path.empty() ? part_ : canonical(path), without_entities(tags_.attribute("objectid")),
            transform_of(tags_.attribute("transform"))};
  }

  XmlTags tags_;
  std::string part_;
  Model model_;
  Object* object_ = nullptr;
  bool found_ = false;
};

class Assembly {
 public:
  explicit Assembly(std::string_view bytes) : archive_(bytes) {}

  ImportedMesh read() {
    const Model& root = model(root_part());
    mesh_.unit_m = root.unit_m;
    if (root.build.empty()) {
      throw ImportError("its build names no object");
    }
    for (const Component& item : root.build) {
      add(item, Transform::Identity(), 0);
    }
    if (mesh_.positions.empty()) {
      throw ImportError("it holds no point and no face");
    }
    if (bad_triangles_ > 0) {
      mesh_.warning = std::to_string(bad_triangles_) +
                      " triangles were dropped: they refer to points that the file does not have.";
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] std::string root_part() const {
    if (archive_.contains(kRelations)) {
      const std::string text = archive_.read(kRelations);
      XmlTags tags(text);
      while (tags.next()) {
        if (tags.name() == "Relationship" && tags.attribute("Type").ends_with("/3dmodel")) {
          return canonical(tags.attribute("Target"));
        }
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
    return models_.emplace(part, ModelReader(archive_.read(part), part).read()).first->second;
  }

  void add(const Component& component, const Transform& outer, unsigned depth) {
    const Model& from = model(component.part);
    const auto found = from.objects.find(component.object);
    if (found == from.objects.end()) {
      throw ImportError("its part \"" + component.part + "\" has no object \"" +
                        component.object.substr(0, 40) + "\"");
    }
    if (depth > kMaxDepth || ++instances_ > kMaxInstances) {
      throw ImportError("its objects contain each other too deeply or too often");
    }
    const Transform transform = outer * component.transform;
    const Object& object = found->second;
    // Another unit of the part is that of its vertices.
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
    for (const Eigen::Vector3d& vertex : object.vertices) {
      mesh_.positions.push_back(transform * (scale * vertex));
    }
    // A reflection reverses the winding: swap two corners.
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

  ZipArchive archive_;
  std::map<std::string, Model, std::less<>> models_;
  ImportedMesh mesh_;
  std::size_t instances_ = 0;
  std::uint64_t bad_triangles_ = 0;
};

}  // namespace

ImportedMesh read_3mf(std::string_view bytes) { return Assembly(bytes).read(); }

}  // namespace tactree::builder
