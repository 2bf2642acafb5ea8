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
#include "mesh_import/slicer_volumes.hpp"
#include "mesh_import/three_mf_model.hpp"
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

class Assembly {
 public:
  explicit Assembly(std::string_view bytes) : archive_(bytes) {}

  ImportedMesh read() {
    ModelPart& root = model(root_part());
    remove_volumes(root);
    mesh_.unit_m = root.unit_m;
    if (root.build.empty()) {
      throw ImportError("its build refers to no object");
    }
    for (const ModelComponent& item : root.build) {
      if (item.printed) {
        add(item, Transform::Identity(), 0);
      } else {
        ++parts_.left_out["item that is not printed"];
      }
    }
    mesh_.warning = parts_.text();
    if (mesh_.positions.empty()) {
      throw ImportError("it contains no points and no faces" +
                        (mesh_.warning.empty() ? "" : ". " + mesh_.warning));
    }
    if (bad_triangles_ > 0) {
      mesh_.warning += (mesh_.warning.empty() ? "" : " ") + std::to_string(bad_triangles_) +
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
                       target = part_path(attribute_of(relation, "Target"));
                     }
                   });
      if (!target.empty()) {
        return target;
      }
    }
    const std::vector<std::string> models = archive_.with_ending(".model");
    if (models.empty()) {
      throw ImportError("it has no part with a model");
    }
    return models.front();
  }

  /// Removes what a slicer has marked as other than the body.
  void remove_volumes(ModelPart& root) {
    if (archive_.contains(kSlic3rVolumes)) {
      remove_slic3r_volumes(parsed(kSlic3rVolumes), root, parts_);
    }
    if (archive_.contains(kOrcaVolumes)) {
      remove_orca_volumes(parsed(kOrcaVolumes), root, parts_);
    }
  }

  ModelPart& model(const std::string& part) {
    const auto found = models_.find(part);
    if (found != models_.end()) {
      return found->second;
    }
    return models_.emplace(part, read_part(part)).first->second;
  }

  [[nodiscard]] ModelPart read_part(const std::string& part) const {
    MeshExtractor extractor;
    const bool extracted = archive_.unpack(part, [&](std::string_view bytes) {
      return extractor.feed(bytes);
    }) && extractor.is_complete();
    if (extracted && !extractor.error().empty()) {
      throw ImportError("its part \"" + part + "\": " + extractor.error());
    }
    if (extracted) {
      try {
        const XmlDocument document(extractor.take_rest(), kXmlLimits);
        return read_model_part(document, part, &extractor.blocks());
      } catch (const XmlError&) {
        // The whole document is parsed below, so that the message states its position.
      }
    }
    const XmlDocument document = parsed(part);
    return read_model_part(document, part, nullptr);
  }

  void add(const ModelComponent& component, const Transform& outer, unsigned depth) {
    const ModelPart& from = model(component.part);
    const auto found = from.objects.find(component.object);
    if (found == from.objects.end()) {
      throw ImportError("its part \"" + component.part + "\" has no object \"" +
                        component.object.substr(0, 40) + "\"");
    }
    if (depth > kMaxDepth || ++instances_ > kMaxInstances) {
      throw ImportError("its objects are nested too deeply or too often");
    }
    const Transform transform = outer * component.transform;
    const ModelObject& object = found->second;
    const std::string_view kind = kind_of_type(object.type);
    if (!kind.empty()) {
      ++parts_.left_out[std::string(kind)];
      return;
    }
    if (!object.type.empty() && object.type != "model") {
      ++parts_.kept["object of the type \"" + object.type.substr(0, 40) + "\""];
    }
    if (!object.unread.empty()) ++parts_.unread[object.unread];
    // If a part has another unit, this unit applies to its vertices.
    add_mesh(object, transform, from.unit_m / mesh_.unit_m);
    for (const ModelComponent& inner : object.components) {
      add(inner, transform, depth + 1);
    }
  }

  void add_mesh(const ModelObject& object, const Transform& transform, double scale) {
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
  std::map<std::string, ModelPart, std::less<>> models_;
  ImportedMesh mesh_;
  NonBodyParts parts_;
  std::size_t instances_ = 0;
  std::uint64_t bad_triangles_ = 0;
};

}  // namespace

ImportedMesh read_3mf(std::string_view bytes) { return Assembly(bytes).read(); }

}  // namespace tactree::builder
