#include "mesh_import/slicer_volumes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "mesh_import/imported_mesh.hpp"
#include "mesh_import/mesh_extractor.hpp"

namespace tactree::builder {
namespace {

struct Kind {
  std::string_view type;
  std::string_view name;  // empty: the body
};

constexpr Kind kVolumeKinds[] = {
    {"", ""},
    {"ModelPart", ""},
    {"normal_part", ""},
    {"ParameterModifier", "modifier"},
    {"modifier_part", "modifier"},
    {"NegativeVolume", "negative volume (not subtracted)"},
    {"negative_part", "negative volume (not subtracted)"},
    {"SupportEnforcer", "support enforcer"},
    {"support_enforcer", "support enforcer"},
    {"SupportBlocker", "support blocker"},
    {"support_blocker", "support blocker"},
};

std::string list_of(const std::map<std::string, std::size_t, std::less<>>& counts) {
  std::string text;
  for (const auto& [kind, count] : counts) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  return text;
}

/// Removes the triangles that are marked, and the vertices that only they use.
void remove_triangles(ModelObject& object, const std::vector<bool>& marked) {
  std::vector<bool> unused(object.vertices.size(), false);
  const auto mark_corners = [&](bool removed) {
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i] != removed) continue;
      for (const std::uint32_t corner : object.triangles[i]) {
        if (corner < unused.size()) unused[corner] = removed;
      }
    }
  };
  mark_corners(true);
  mark_corners(false);
  std::vector<std::uint32_t> places(unused.size());
  std::uint32_t place = 0;
  for (std::size_t i = 0; i < unused.size(); ++i) {
    places[i] = place;
    if (!unused[i]) object.vertices[place++] = object.vertices[i];
  }
  object.vertices.resize(place);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i]) continue;
    std::array<std::uint32_t, 3> triangle = object.triangles[i];
    for (std::uint32_t& corner : triangle) {
      corner = corner < places.size() ? places[corner] : std::numeric_limits<std::uint32_t>::max();
    }
    object.triangles[kept++] = triangle;
  }
  object.triangles.resize(kept);
}

std::string_view type_of_slic3r_volume(pugi::xml_node volume) {
  std::string_view type;
  bool modifier = false;  // of files before the types
  for_children(volume, "metadata", [&](pugi::xml_node metadata) {
    const std::string_view key = attribute_of(metadata, "key");
    const std::string_view value = attribute_of(metadata, "value");
    if (key == "volume_type") type = value;
    if (key == "modifier" && value == "1") modifier = true;
  });
  return type.empty() && modifier ? "ParameterModifier" : type;
}

/// Marks the triangles of a volume.
void mark_range(pugi::xml_node volume, std::vector<bool>& marked) {
  const std::uint32_t first = index_of(attribute_of(volume, "firstid"));
  const std::uint32_t last = index_of(attribute_of(volume, "lastid"));
  if (first > last || last >= marked.size()) {
    throw ImportError("its part \"" + std::string(kSlic3rVolumes) + "\": a volume has triangles " +
                      std::string(attribute_of(volume, "firstid").substr(0, 20)) + " to " +
                      std::string(attribute_of(volume, "lastid").substr(0, 20)) + " of " +
                      std::to_string(marked.size()) + "; save the file again with the slicer");
  }
  std::fill(marked.begin() + first, marked.begin() + last + 1, true);
}

template <typename Visit>
void for_objects(const XmlDocument& settings, ModelPart& root, Visit&& visit) {
  for_children(child_of(settings.root(), "config"), "object", [&](pugi::xml_node element) {
    const auto found = root.objects.find(attribute_of(element, "id"));
    if (found != root.objects.end()) visit(element, found->second);
  });
}

}  // namespace

std::string NonBodyParts::text() const {
  std::string text;
  if (!left_out.empty()) {
    text = "Parts of the build that are not the body were left out: " + list_of(left_out) +
           ". To feel one of them, make it a printed part of the body in the slicer.";
  }
  if (!kept.empty()) {
    text += (text.empty() ? "" : " ") + std::string("Parts that may not belong to the body were ") +
            "read: " + list_of(kept) + ".";
  }
  if (!unread.empty()) {
    text += (text.empty() ? "" : " ") + std::string("Shapes that are not meshes were left out: ") +
            list_of(unread) + ". Export the model as STL to feel them.";
  }
  return text;
}

std::string_view kind_of_type(std::string_view type) {
  if (type == "support") return "support";
  if (type == "solidsupport") return "solid support";
  if (type == "other") return "object of the type \"other\"";
  return type == "modifier" || type == "support blocker" ? type : std::string_view{};
}

std::string_view kind_of_volume(std::string_view type, NonBodyParts& parts) {
  for (const Kind& kind : kVolumeKinds) {
    if (kind.type == type) return kind.name;
  }
  ++parts.kept["volume of the type \"" + std::string(type.substr(0, 40)) + "\""];
  return {};
}

void remove_slic3r_volumes(const XmlDocument& settings, ModelPart& root, NonBodyParts& parts) {
  for_objects(settings, root, [&](pugi::xml_node element, ModelObject& object) {
    std::vector<bool> marked(object.triangles.size(), false);
    bool any = false;
    for_children(element, "volume", [&](pugi::xml_node volume) {
      const std::string_view kind = kind_of_volume(type_of_slic3r_volume(volume), parts);
      if (kind.empty()) return;
      mark_range(volume, marked);
      ++parts.left_out[std::string(kind)];
      any = true;
    });
    if (any) remove_triangles(object, marked);
  });
}

void remove_orca_volumes(const XmlDocument& settings, ModelPart& root, NonBodyParts& parts) {
  for_objects(settings, root, [&](pugi::xml_node element, ModelObject& object) {
    for_children(element, "part", [&](pugi::xml_node part) {
      const std::string_view kind = kind_of_volume(attribute_of(part, "subtype"), parts);
      if (kind.empty()) return;
      const std::size_t removed = std::erase_if(
          object.components,
          [&](const ModelComponent& inner) { return inner.object == attribute_of(part, "id"); });
      std::map<std::string, std::size_t, std::less<>>& list =
          removed > 0 ? parts.left_out : parts.kept;
      ++list[std::string(kind)];
    });
  });
}

}  // namespace tactree::builder
