#include "mesh_import/amf_object.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/mesh_extractor.hpp"

namespace tactree::builder {
namespace {

constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();

/// Null if the element has no colour, or one that is a formula.
std::optional<AmfColour> colour_of(pugi::xml_node element) {
  const pugi::xml_node colour = child_of(element, "color");
  if (colour.empty()) return std::nullopt;
  AmfColour bytes{};
  constexpr std::array<std::string_view, 3> kChannels = {"r", "g", "b"};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> number = number_of(child_of(colour, kChannels[i]).child_value());
    if (!number || std::isnan(*number)) return std::nullopt;
    bytes[i] = colour_byte(*number);
  }
  return bytes;
}

/// The kind of a volume that is not the body; empty for the body.
std::string_view kind_of_amf_volume(pugi::xml_node volume, NonBodyParts& parts) {
  std::string_view type;
  bool modifier = false;  // of files before the types
  for_children(volume, "metadata", [&](pugi::xml_node metadata) {
    const std::string_view key = attribute_of(metadata, "type");
    const std::string_view value = metadata.child_value();
    if (key == "slic3r.volume_type") type = value;
    if (key == "slic3r.modifier" && value == "1") modifier = true;
  });
  if (attribute_of(volume, "type") == "support") return "support";
  return kind_of_volume(type.empty() && modifier ? "ParameterModifier" : type, parts);
}

class ObjectReader {
 public:
  ObjectReader(pugi::xml_node element, const AmfColours& materials, NonBodyParts& parts)
      : element_(element), materials_(materials), parts_(parts) {}

  AmfObject read() {
    for_children(element_, "mesh", [&](pugi::xml_node mesh) { read_mesh(mesh); });
    return std::move(object_);
  }

 private:
  void read_mesh(pugi::xml_node mesh) {
    vertices_.clear();
    colours_.clear();
    for_children(mesh, "vertices", [&](pugi::xml_node vertices) {
      for_children(vertices, "vertex", [&](pugi::xml_node vertex) { read_vertex(vertex); });
    });
    bool volumes = false;
    for_children(mesh, "volume", [&](pugi::xml_node volume) {
      volumes = true;
      const std::string_view kind = kind_of_amf_volume(volume, parts_);
      if (kind.empty()) {
        read_volume(volume);
      } else {
        ++parts_.left_out[std::string(kind)];
      }
    });
    if (volumes) return;
    places_.assign(vertices_.size(), kNowhere);
    for (std::size_t i = 0; i < vertices_.size(); ++i) (void)place_of(i, colour_of(element_));
  }

  void read_vertex(pugi::xml_node vertex) {
    constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
    const pugi::xml_node coordinates = child_of(vertex, "coordinates");
    Eigen::Vector3d position;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const std::string_view text =
          child_of(coordinates, kAxes[static_cast<std::size_t>(axis)]).child_value();
      const std::optional<double> number = number_of(text);
      if (!number) throw not_a(text, "coordinate of vertex " + std::to_string(vertices_.size()));
      position[axis] = *number;
    }
    vertices_.push_back(position);
    colours_.push_back(colour_of(vertex));
  }

  void read_volume(pugi::xml_node volume) {
    places_.assign(vertices_.size(), kNowhere);
    const std::optional<AmfColour> colour = colour_of_volume(volume);
    for_children(volume, "triangle", [&](pugi::xml_node triangle) {
      constexpr std::array<const char*, 3> kCorners = {"v1", "v2", "v3"};
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) {
        corners[i] = index_of(child_of(triangle, kCorners[i]).child_value());
      }
      if (*std::max_element(corners.begin(), corners.end()) >= vertices_.size()) {
        ++object_.bad_triangles;
        return;
      }
      for (std::uint32_t& corner : corners) corner = place_of(corner, colour);
      object_.triangles.push_back(corners);
    });
  }

  /// The colour of the points that have none.
  [[nodiscard]] std::optional<AmfColour> colour_of_volume(pugi::xml_node volume) const {
    if (const auto colour = colour_of(volume)) return colour;
    if (const auto colour = colour_of(element_)) return colour;
    const auto found = materials_.find(attribute_of(volume, "materialid"));
    return found == materials_.end() ? std::nullopt : std::optional(found->second);
  }

  /// The place of a vertex among the points of the object, where it is put at its first use.
  std::uint32_t place_of(std::size_t vertex, const std::optional<AmfColour>& colour) {
    std::uint32_t& place = places_[vertex];
    if (place != kNowhere) return place;
    if (object_.points.size() >= kNowhere) throw ImportError("it has more than 2^32 points");
    place = static_cast<std::uint32_t>(object_.points.size());
    object_.points.push_back(vertices_[vertex]);
    const std::optional<AmfColour>& own = colours_[vertex] ? colours_[vertex] : colour;
    if (own) object_.colours.push_back(*own);
    return place;
  }

  pugi::xml_node element_;
  const AmfColours& materials_;
  NonBodyParts& parts_;
  AmfObject object_;
  // Of the present mesh.
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::optional<AmfColour>> colours_;
  std::vector<std::uint32_t> places_;
};

}  // namespace

AmfColours read_materials(pugi::xml_node amf) {
  AmfColours materials;
  for_children(amf, "material", [&](pugi::xml_node material) {
    if (const auto colour = colour_of(material)) {
      materials.emplace(attribute_of(material, "id"), *colour);
    }
  });
  return materials;
}

AmfObject read_amf_object(pugi::xml_node element, const AmfColours& materials,
                          NonBodyParts& parts) {
  return ObjectReader(element, materials, parts).read();
}

}  // namespace tactree::builder
