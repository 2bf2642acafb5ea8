#include "mesh_import/amf_file.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "mesh_import/amf_object.hpp"
#include "mesh_import/mesh_extractor.hpp"
#include "mesh_import/slicer_volumes.hpp"
#include "mesh_import/xml_document.hpp"
#include "mesh_import/zip_archive.hpp"

namespace tactree::builder {
namespace {

using AmfTransform = Eigen::Affine3d;

constexpr unsigned kMaxNesting = 32;                 // of constellations
constexpr std::size_t kMaxAmfInstances = 1'000'000;  // of objects
// A tree that needs more memory than the process may use is refused when it is built.
constexpr XmlLimits kAmfLimits{std::size_t{1} << 30, std::size_t{1} << 28};

struct Instance {
  std::string object;  // or a constellation
  AmfTransform transform = AmfTransform::Identity();
  bool printed = true;
};

/// The elements of an instance: shift and rotations of the standard, scales and mirrors of slicers.
class InstanceReader {
 public:
  Instance read(pugi::xml_node element) {
    for (const pugi::xml_node child : element.children()) {
      if (child.type() == pugi::node_element) take(local_name(child), child.child_value());
    }
    // Turned about x, then y, then z, then moved.
    Instance instance{std::string(attribute_of(element, "objectid")), {}, printed_};
    instance.transform =
        Eigen::Translation3d(shift_) * Eigen::AngleAxisd(angles_.z(), Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(angles_.y(), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(angles_.x(), Eigen::Vector3d::UnitX()) * Eigen::Scaling(scales_);
    return instance;
  }

 private:
  void take(std::string_view name, std::string_view text) {
    if (name == "metadata") return;
    const std::optional<double> number = number_of(text);
    if (!number || !std::isfinite(*number)) throw not_a(text, "number of an instance");
    const Eigen::Index axis = name.empty() ? -1 : name.back() - 'x';
    const bool axes = axis >= 0 && axis <= 2;
    const std::string_view stem = axes ? name.substr(0, name.size() - 1) : name;
    if (axes && stem == "delta") {
      shift_[axis] = *number;
    } else if (axes && stem == "r") {
      angles_[axis] = *number * std::numbers::pi / 180.0;
    } else if (axes && stem == "scale") {
      scales_[axis] *= *number;
    } else if (axes && stem == "mirror") {
      scales_[axis] *= *number < 0 ? -1.0 : 1.0;
    } else if (name == "scale") {
      scales_ *= *number;
    } else if (name == "printable") {
      printed_ = *number != 0.0;
    } else {
      throw ImportError("an instance has the element \"" + std::string(name.substr(0, 40)) +
                        "\", whose meaning is not known");
    }
  }

  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d angles_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d scales_ = Eigen::Vector3d::Ones();
  bool printed_ = true;
};

class AmfReader {
 public:
  explicit AmfReader(pugi::xml_node root) : root_(root) {}

  ImportedMesh read() {
    if (root_.empty()) throw ImportError("it has no element \"amf\"");
    mesh_.unit_m = metres_of_print_unit(attribute_of(root_, "unit"));
    const AmfColours materials = read_materials(root_);
    for_children(root_, "object", [&](pugi::xml_node element) {
      const std::string id(attribute_of(element, "id"));
      order_.push_back(id);
      if (!objects_.emplace(id, read_amf_object(element, materials, parts_)).second) {
        throw ImportError("it has two objects with the id \"" + id.substr(0, 40) + "\"");
      }
    });
    read_constellations();
    place_all();
    finish();
    return std::move(mesh_);
  }

 private:
  void read_constellations() {
    for_children(root_, "constellation", [&](pugi::xml_node element) {
      const std::string id(attribute_of(element, "id"));
      std::vector<Instance>& instances = constellations_[id];
      for_children(element, "instance", [&](pugi::xml_node instance) {
        instances.push_back(InstanceReader().read(instance));
        placed_.insert(instances.back().object);
      });
    });
  }

  /// Constellations and objects that no instance refers to are at their own place.
  void place_all() {
    for (const auto& [id, instances] : constellations_) {
      if (!placed_.contains(id)) add(id, AmfTransform::Identity(), 0);
    }
    for (const std::string& id : order_) {
      if (placed_.contains(id) || constellations_.contains(id)) continue;
      add(id, AmfTransform::Identity(), 0);
      if (!constellations_.empty()) ++parts_.kept["object outside of the constellations"];
    }
  }

  void add(const std::string& id, const AmfTransform& transform, unsigned depth) {
    if (depth > kMaxNesting || ++instances_ > kMaxAmfInstances) {
      throw ImportError("its constellations are nested too deeply or too often");
    }
    if (const auto found = constellations_.find(id); found != constellations_.end()) {
      for (const Instance& instance : found->second) {
        if (instance.printed) {
          add(instance.object, transform * instance.transform, depth + 1);
        } else {
          ++parts_.left_out["instance that is not printed"];
        }
      }
      return;
    }
    const auto object = objects_.find(id);
    if (object == objects_.end()) {
      throw ImportError("its constellation refers to the object \"" + id.substr(0, 40) +
                        "\", which it does not have");
    }
    add_object(object->second, transform);
  }

  void add_object(const AmfObject& object, const AmfTransform& transform) {
    if (mesh_.positions.size() + object.points.size() >=
        std::numeric_limits<std::uint32_t>::max()) {
      throw ImportError("it has more than 2^32 points");
    }
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const Eigen::Vector3d& point : object.points) mesh_.positions.push_back(transform * point);
    all_coloured_ = all_coloured_ && object.colours.size() == object.points.size();
    mesh_.colours.insert(mesh_.colours.end(), object.colours.begin(), object.colours.end());
    const bool mirrored = transform.linear().determinant() < 0;
    for (std::array<std::uint32_t, 3> triangle : object.triangles) {
      // A reflection reverses the winding, so two vertices are swapped.
      if (mirrored) std::swap(triangle[1], triangle[2]);
      for (std::uint32_t& corner : triangle) corner += first;
      mesh_.triangles.push_back(triangle);
    }
    bad_triangles_ += object.bad_triangles;
  }

  void finish() {
    mesh_.warning = parts_.text();
    if (mesh_.positions.empty()) {
      throw ImportError("it contains no points and no faces" +
                        (mesh_.warning.empty() ? "" : ". " + mesh_.warning));
    }
    if (!all_coloured_) mesh_.colours.clear();
    if (bad_triangles_ > 0) {
      mesh_.warning += (mesh_.warning.empty() ? "" : " ") + std::to_string(bad_triangles_) +
                       " triangles were dropped: they refer to points that the file does not have.";
    }
  }

  pugi::xml_node root_;
  ImportedMesh mesh_;
  NonBodyParts parts_;
  std::map<std::string, AmfObject, std::less<>> objects_;
  std::vector<std::string> order_;
  std::map<std::string, std::vector<Instance>, std::less<>> constellations_;
  std::set<std::string, std::less<>> placed_;
  std::size_t instances_ = 0;
  std::uint64_t bad_triangles_ = 0;
  bool all_coloured_ = true;
};

/// An AMF may be the only file of a zip archive.
std::string unpacked(const std::string& bytes) {
  const ZipArchive archive(bytes);
  const std::vector<std::string> files = archive.with_ending(".amf");
  if (files.size() != 1) {
    throw ImportError("it is an archive of " + std::to_string(files.size()) +
                      " AMF files, not of one");
  }
  return archive.read(files.front());
}

}  // namespace

ImportedMesh read_amf(std::string text) {
  if (text.starts_with("PK")) {
    text = unpacked(text);
  }
  try {
    const XmlDocument document(std::move(text), kAmfLimits);
    return AmfReader(child_of(document.root(), "amf")).read();
  } catch (const XmlTooLarge& error) {
    throw ImportError("it is too large: " + std::string(error.what()));
  } catch (const XmlError& error) {
    throw ImportError("it is damaged or was cut off: " + std::string(error.what()));
  }
}

}  // namespace tactree::builder
