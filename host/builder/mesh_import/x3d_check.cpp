#include "mesh_import/x3d_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "mesh_import/document_notes.hpp"
#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/mesh_extractor.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {
namespace {

constexpr std::string_view kGroups[] = {"Group", "StaticGroup", "Transform", "Switch", "Scene"};

constexpr std::string_view kGeometries[] = {"Arc2D",
                                            "ArcClose2D",
                                            "Box",
                                            "Circle2D",
                                            "Cone",
                                            "Cylinder",
                                            "Disk2D",
                                            "ElevationGrid",
                                            "Extrusion",
                                            "IndexedFaceSet",
                                            "IndexedLineSet",
                                            "IndexedTriangleFanSet",
                                            "IndexedTriangleSet",
                                            "IndexedTriangleStripSet",
                                            "LineSet",
                                            "PointSet",
                                            "Polyline2D",
                                            "Polypoint2D",
                                            "Rectangle2D",
                                            "Sphere",
                                            "TriangleFanSet",
                                            "TriangleSet",
                                            "TriangleSet2D",
                                            "TriangleStripSet"};

/// Nodes of a shape or of its geometry that hold no positions.
constexpr std::string_view kOthers[] = {"Appearance",
                                        "Color",
                                        "ColorRGBA",
                                        "Coordinate",
                                        "Normal",
                                        "FogCoordinate",
                                        "TextureCoordinate",
                                        "TextureCoordinateGenerator",
                                        "MultiTextureCoordinate",
                                        "FloatVertexAttribute",
                                        "Matrix3VertexAttribute",
                                        "Matrix4VertexAttribute"};

template <std::size_t Size>
bool is_one_of(std::string_view name, const std::string_view (&names)[Size]) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

[[noreturn]] void refuse_node(std::string_view name) {
  throw ImportError("its node \"" + std::string(name.substr(0, 40)) +
                    "\" has shapes that are not read; export it as glTF, PLY or STL");
}

class X3dCheck {
 public:
  explicit X3dCheck(pugi::xml_node root) : root_(root) {}

  SceneNotes check() {
    for_children(child_of(root_, "head"), "unit", [&](pugi::xml_node unit) { take_unit(unit); });
    const pugi::xml_node scene = child_of(root_, "Scene");
    for (pugi::xml_node at = scene.first_child(); !at.empty(); at = next_node(at, scene)) {
      if (at.type() == pugi::node_element) take(at);
    }
    if (texts_ > 0) {
      notes_.warning =
          std::to_string(texts_) + " nodes \"Text\" were left out: letters are not read.";
    }
    return notes_;
  }

 private:
  void take(pugi::xml_node node) {
    const std::string_view name = local_name(node);
    const bool used = !attribute_of(node, "USE").empty();
    if (name == "Shape" || name == "Inline" || (used && is_one_of(name, kGroups))) {
      check_groups(node);
    }
    if (name == "ExternProtoDeclare") refuse_node(name);
    if (name == "Coordinate") check_numbers(attribute_of(node, "point"));
    if (name == "Shape") check_shape(node);
  }

  /// The shapes of a node are read only inside of some nodes.
  static void check_groups(pugi::xml_node node) {
    for (pugi::xml_node at = node.parent(); local_name(at) != "Scene"; at = at.parent()) {
      if (!is_one_of(local_name(at), kGroups)) refuse_node(local_name(at));
    }
  }

  /// assimp reads the beginning of a word as a number.
  static void check_numbers(std::string_view text) {
    const std::size_t at = text.find_first_not_of("0123456789+-.eE, \t\r\n");
    if (at == std::string_view::npos) return;
    const std::size_t begin = text.find_last_of(", \t\r\n", at) + 1;  // 0 if there is none
    throw not_a(text.substr(begin, 20), "coordinate of a point");
  }

  void check_shape(pugi::xml_node shape) {
    for (const pugi::xml_node child : shape.children()) {
      const std::string_view name = local_name(child);
      if (child.type() != pugi::node_element || is_one_of(name, kOthers)) continue;
      if (name.starts_with("Metadata")) continue;
      if (name == "Text") {
        ++texts_;
        continue;
      }
      if (!is_one_of(name, kGeometries)) refuse_node(name);
      for (const pugi::xml_node part : child.children()) {
        const std::string_view inner = local_name(part);
        if (part.type() != pugi::node_element || is_one_of(inner, kOthers)) continue;
        if (!inner.starts_with("Metadata")) refuse_node(inner);
      }
    }
  }

  void take_unit(pugi::xml_node unit) {
    const std::string_view category = attribute_of(unit, "category");
    if (category != "length" && category != "angle") return;
    const std::string_view text = attribute_of(unit, "conversionFactor");
    const std::optional<double> factor = number_of(text);
    if (!factor || !(*factor > 0.0) || !std::isfinite(*factor)) {
      throw not_a(text, "factor of a unit");
    }
    if (category == "length") notes_.unit_m = *factor;
    if (category == "angle" && *factor != 1.0) {
      throw ImportError(
          "its angles are not in radians, which are read; export it as glTF, PLY or STL");
    }
  }

  pugi::xml_node root_;
  SceneNotes notes_;
  std::size_t texts_ = 0;
};

}  // namespace

SceneNotes check_x3d(std::string text) {
  return notes_of_document(
      std::move(text), [](pugi::xml_node root) { return X3dCheck(child_of(root, "X3D")).check(); });
}

}  // namespace tactree::builder
