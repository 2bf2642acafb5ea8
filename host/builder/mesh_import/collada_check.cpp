#include "mesh_import/collada_check.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "mesh_import/document_notes.hpp"
#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/mesh_extractor.hpp"
#include "mesh_import/xml_document.hpp"

namespace tactree::builder {
namespace {

/// A number of elements, and the name of the first.
struct Found {
  std::size_t count = 0;
  std::string first;

  void add(std::string_view name) {
    if (count++ == 0) first = name.substr(0, 40);
  }
  [[nodiscard]] std::string text() const { return std::to_string(count) + " (\"" + first + "\")"; }
};

class ColladaCheck {
 public:
  explicit ColladaCheck(pugi::xml_node root) : root_(root) {}

  SceneNotes check() {
    check_unit();
    visit([this](pugi::xml_node node) { take_definition(node); });
    visit([this](pugi::xml_node node) { take_reference(node); });
    SceneNotes notes;
    const auto note = [&](const Found& found, const char* text) {
      if (found.count == 0) return;
      notes.warning += (notes.warning.empty() ? "" : " ") + found.text() + text;
    };
    note(missing_,
         " of its instances refer to a part that the file does not have: the model is incomplete. "
         "Export the file again.");
    note(others_,
         " of its geometries are not meshes and were left out. Convert them to meshes in Blender.");
    note(morphs_,
         " of its controllers morph a mesh, which is read without it. Apply the shape keys in "
         "Blender.");
    return notes;
  }

 private:
  template <typename Visit>
  void visit(Visit&& take) const {
    for (pugi::xml_node at = root_.first_child(); !at.empty(); at = next_node(at, root_)) {
      if (at.type() == pugi::node_element) take(at);
    }
  }

  /// assimp multiplies by any number.
  void check_unit() const {
    const std::string_view text = attribute_of(child_of(child_of(root_, "asset"), "unit"), "meter");
    const std::optional<double> metres = number_of(text);
    if (metres && !(*metres > 0.0 && std::isfinite(*metres))) {
      throw not_a(text, "unit in metres, which is more than 0");
    }
  }

  void take_definition(pugi::xml_node node) {
    const std::string_view name = local_name(node);
    if (name != "geometry" && name != "controller" && name != "node") return;
    const std::string_view id = attribute_of(node, "id");
    ids_.emplace(id);
    if (name == "geometry" && child_of(node, "mesh").empty()) others_.add(id);
    if (name == "controller" && !child_of(node, "morph").empty()) morphs_.add(id);
  }

  void take_reference(pugi::xml_node node) {
    const std::string_view name = local_name(node);
    std::string_view url;
    if (name == "instance_geometry" || name == "instance_controller" || name == "instance_node") {
      url = attribute_of(node, "url");
    } else if (name == "skin") {
      url = attribute_of(node, "source");
    } else {
      if (name == "skew") {
        throw ImportError("a node is skewed, which is not read; apply the transforms in Blender");
      }
      return;
    }
    if (url.find('#') != 0 && url.find('#') != std::string_view::npos) {
      throw ImportError("its part \"" + std::string(url.substr(0, 80)) +
                        "\" is in another file, which is not read; join the files in Blender");
    }
    if (!url.starts_with('#') || !ids_.contains(url.substr(1))) missing_.add(url);
  }

  pugi::xml_node root_;
  std::set<std::string, std::less<>> ids_;
  Found missing_;
  Found others_;
  Found morphs_;
};

}  // namespace

SceneNotes check_collada(std::string text) {
  return notes_of_document(std::move(text), [](pugi::xml_node root) {
    return ColladaCheck(child_of(root, "COLLADA")).check();
  });
}

}  // namespace tactree::builder
