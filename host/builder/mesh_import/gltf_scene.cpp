#include "mesh_import/gltf_scene.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "mesh_import/gltf_nodes.hpp"
#include "mesh_import/meshopt_view.hpp"

namespace tactree::builder {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// True for required extensions that do not change the shape or that this reader supports.
bool is_supported(const std::string& extension) {
  constexpr std::string_view kKnown[] = {
      "KHR_mesh_quantization", kMeshopt,           kInstancing,        "KHR_texture_transform",
      "KHR_texture_basisu",    "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds",
      "KHR_lights_punctual",   "KHR_xmp_json_ld",  "KHR_xmp",          "KHR_animation_pointer",
      "KHR_node_visibility"};
  return extension.starts_with("KHR_materials_") ||
         std::find(std::begin(kKnown), std::end(kKnown), extension) != std::end(kKnown);
}

void check_extensions(const json& root, std::string_view also = {}) {
  for (const json& name : root.value("extensionsRequired", json::array())) {
    const std::string extension = name.get<std::string>();
    if (!is_supported(extension) && extension != also) {
      const bool compression = extension.ends_with("_compression");
      throw ImportError(
          (compression ? "its data is compressed with " : "it requires the extension ") +
          extension.substr(0, 60) + ", which is not supported");
    }
  }
}

/// Expands a strip or fan: returns three vertices per triangle.
std::vector<std::uint32_t> corners_of(const std::vector<std::uint32_t>& list, std::size_t mode) {
  constexpr std::size_t kStrip = 5;
  constexpr std::size_t kFan = 6;
  if (mode != kStrip && mode != kFan) {
    return list;
  }
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 2; i < list.size(); ++i) {
    const bool swapped = mode == kStrip && i % 2 == 1;
    const std::uint32_t first = mode == kFan ? list[0] : list[i - 2];
    corners.insert(corners.end(),
                   {swapped ? list[i - 1] : first, swapped ? first : list[i - 1], list[i]});
  }
  return corners;
}

class GltfScene {
 public:
  explicit GltfScene(GltfFile& file) : file_(file), nodes_(file) {}

  ImportedMesh read() {
    for (const std::size_t node : nodes_.shown()) {
      add_node(node);
    }
    if (!all_normals_) {
      mesh_.normals.clear();
    }
    if (!all_colours_) {
      mesh_.colours.clear();
    }
    mesh_.unit_m = 1.0;
    warn();
    return std::move(mesh_);
  }

 private:
  /// Points of a primitive in the frame of the scene.
  struct Points {
    std::vector<double> positions;  // three each
    std::vector<double> normals;
    std::vector<double> colours;
    std::size_t colour_width = 3;
    std::size_t count = 0;
  };

  void add_node(std::size_t number) {
    const json& node = file_.at("nodes", number);
    if (!node.contains("mesh")) {
      return;
    }
    const json& mesh = file_.at("meshes", gltf_count(node, "mesh"));
    const std::vector<Matrix4d> places = nodes_.places(number);
    const std::vector<Matrix4d> joints = nodes_.joints(number);
    const json weights = node.contains("weights") ? node["weights"] : mesh.value("weights", json());
    for (const json& primitive : mesh.value("primitives", json::array())) {
      add_primitive(primitive, places, joints, weights);
    }
  }

  void add_primitive(const json& primitive, const std::vector<Matrix4d>& places,
                     const std::vector<Matrix4d>& joints, const json& weights) {
    constexpr std::size_t kTriangles = 4;
    const std::size_t mode = gltf_count(primitive, "mode", kTriangles);
    const json attributes = primitive.value("attributes", json::object());
    const std::size_t position = gltf_count(attributes, "POSITION", kNoIndex);
    if (position == kNoIndex) {
      return;
    }
    if (mode >= 1 && mode < kTriangles) {
      ++lines_;
      return;
    }
    Points points;
    points.positions = file_.numbers(position, 3);
    points.count = points.positions.size() / 3;
    read_normals_and_colours(attributes, points);
    const bool morphed = morph(primitive, weights, points);
    if (morphed) {
      points.normals.clear();
    }
    const std::vector<std::uint32_t> corners =
        mode >= kTriangles ? corners_of(indices_of(primitive, points.count), mode)
                           : std::vector<std::uint32_t>{};
    for (const Matrix4d& place : places) {
      const std::vector<Matrix4d> placed = transforms(attributes, place, joints, points.count);
      if (mesh_.positions.size() + points.count >= std::numeric_limits<std::uint32_t>::max()) {
        throw ImportError("it has more than 2^32 points");
      }
      const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
      add_points(points, placed);
      const bool mirrored = !placed.empty() && placed[0].topLeftCorner<3, 3>().determinant() < 0;
      add_triangles(corners, first, points.count, mirrored);
    }
  }

  void read_normals_and_colours(const json& attributes, Points& points) {
    if (attributes.contains("NORMAL")) {
      points.normals = file_.numbers(gltf_count(attributes, "NORMAL"), 3);
      check_count(points.normals.size(), 3, points, "NORMAL");
    }
    if (attributes.contains("COLOR_0")) {
      const std::size_t accessor = gltf_count(attributes, "COLOR_0");
      points.colour_width = file_.width(accessor) == 4 ? 4 : 3;
      points.colours = file_.numbers(accessor, points.colour_width);
      check_count(points.colours.size(), points.colour_width, points, "COLOR_0");
    }
  }

  static void check_count(std::size_t numbers, std::size_t width, const Points& points,
                          const std::string& name) {
    if (numbers != width * points.count) {
      throw ImportError("a primitive has " + std::to_string(points.count) + " positions and " +
                        std::to_string(numbers / width) + " entries of " + name);
    }
  }

  /// Adds the displacements of the morph targets. Returns true if there are any.
  bool morph(const json& primitive, const json& weights, Points& points) {
    bool morphed = false;
    const json targets = primitive.value("targets", json::array());
    for (std::size_t i = 0; i < targets.size() && i < weights.size(); ++i) {
      const double weight = weights[i].get<double>();
      if (weight == 0.0 || !targets[i].contains("POSITION")) {
        continue;
      }
      const std::vector<double> offsets = file_.numbers(gltf_count(targets[i], "POSITION"), 3);
      check_count(offsets.size(), 3, points, "a morph target");
      for (std::size_t k = 0; k < offsets.size(); ++k) {
        points.positions[k] += weight * offsets[k];
      }
      morphed = true;
    }
    return morphed;
  }

  /// Returns one transform for all points, or one per point of a skin. The points of a skin are
  /// placed by its joints, not by the transform of the node.
  std::vector<Matrix4d> transforms(const json& attributes, const Matrix4d& world,
                                   const std::vector<Matrix4d>& joints, std::size_t count) {
    if (joints.empty() || !attributes.contains("JOINTS_0")) {
      return {world};
    }
    std::vector<Matrix4d> placed(count, Matrix4d::Zero());
    std::vector<double> sums(count, 0.0);
    for (std::size_t set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
      const std::string joints_name = "JOINTS_" + std::to_string(set);
      const std::string weights_name = "WEIGHTS_" + std::to_string(set);
      const std::vector<double> indices =
          file_.numbers(gltf_count(attributes, joints_name.c_str()), 4);
      const std::vector<double> weights =
          file_.numbers(gltf_count(attributes, weights_name.c_str(), kNoIndex), 4);
      if (indices.size() != 4 * count || weights.size() != 4 * count) {
        throw ImportError("a skin has different numbers of weights and points");
      }
      for (std::size_t k = 0; k < indices.size(); ++k) {
        if (!(weights[k] > 0.0)) {
          continue;
        }
        if (!(indices[k] < static_cast<double>(joints.size()))) {
          throw ImportError("a point refers to a joint that its skin does not have");
        }
        placed[k / 4] += weights[k] * joints[static_cast<std::size_t>(indices[k])];
        sums[k / 4] += weights[k];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (sums[i] > 0.0) {
        placed[i] /= sums[i];
      } else {
        placed[i] = world;
        ++loose_points_;
      }
    }
    return placed;
  }

  void add_points(const Points& points, const std::vector<Matrix4d>& placed) {
    all_normals_ = all_normals_ && !points.normals.empty();
    all_colours_ = all_colours_ && !points.colours.empty();
    Eigen::Matrix3d for_normals = Eigen::Matrix3d::Identity();
    for (std::size_t i = 0; i < points.count; ++i) {
      const Matrix4d& transform = placed.size() == 1 ? placed[0] : placed[i];
      const Eigen::Map<const Vector3d> position(points.positions.data() + 3 * i);
      mesh_.positions.emplace_back(transform.topLeftCorner<3, 3>() * position +
                                   transform.topRightCorner<3, 1>());
      if (all_normals_) {
        // Normals transform by the inverse transpose, also for a reflection.
        if (i == 0 || placed.size() > 1) {
          for_normals = transform.topLeftCorner<3, 3>().inverse().transpose();
        }
        const Eigen::Map<const Vector3d> normal(points.normals.data() + 3 * i);
        mesh_.normals.emplace_back((for_normals * normal).normalized().cast<float>());
      }
      if (all_colours_) {
        const double* colour = points.colours.data() + points.colour_width * i;
        mesh_.colours.push_back(
            {colour_byte(colour[0]), colour_byte(colour[1]), colour_byte(colour[2])});
      }
    }
  }

  std::vector<std::uint32_t> indices_of(const json& primitive, std::size_t count) {
    if (primitive.contains("indices")) {
      return file_.indices(gltf_count(primitive, "indices"));
    }
    std::vector<std::uint32_t> indices(count);
    for (std::size_t i = 0; i < count; ++i) {
      indices[i] = static_cast<std::uint32_t>(i);
    }
    return indices;
  }

  void add_triangles(const std::vector<std::uint32_t>& corners, std::uint32_t first,
                     std::size_t count, bool mirrored) {
    for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) {
      const auto highest = std::max({corners[i], corners[i + 1], corners[i + 2]});
      if (highest >= count) {
        ++bad_triangles_;
        continue;
      }
      // A reflection reverses the winding, so two vertices are swapped.
      mesh_.triangles.push_back({first + corners[i], first + corners[i + (mirrored ? 2 : 1)],
                                 first + corners[i + (mirrored ? 1 : 2)]});
    }
  }

  void warn() {
    const auto add = [&](std::uint64_t count, const char* text) {
      if (count == 0) {
        return;
      }
      mesh_.warning += (mesh_.warning.empty() ? "" : " ") + std::to_string(count) + text;
    };
    add(bad_triangles_,
        " triangles were dropped: they refer to points that the file does not have.");
    add(lines_, " sets of lines were left out.");
    add(loose_points_, " points of a skin refer to no joint.");
    add(nodes_.hidden(),
        " hidden nodes and the nodes below them were left out (KHR_node_visibility).");
    constexpr std::size_t kPadding = 3;
    if (file_.undeclared_bytes() > kPadding) {
      add(file_.undeclared_bytes(),
          " bytes follow the size that the header declares (is this two joined files?).");
    }
  }

  GltfFile& file_;
  GltfNodes nodes_;
  ImportedMesh mesh_;
  bool all_normals_ = true;
  bool all_colours_ = true;
  std::uint64_t bad_triangles_ = 0;
  std::uint64_t lines_ = 0;
  std::uint64_t loose_points_ = 0;
};

bool uses_draco(const json& root) {
  for (const json& mesh : root.value("meshes", json::array())) {
    for (const json& primitive : mesh.value("primitives", json::array())) {
      if (primitive.value("extensions", json::object()).contains(kDraco)) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

bool is_draco_gltf(const GltfFile& file) {
  try {
    const json& root = file.root();
    if (!uses_draco(root)) {
      return false;
    }
    check_extensions(root, kDraco);
    const auto refuse_with = [](const std::string& what) {
      throw ImportError("it has " + what + " and data compressed with " + kDraco +
                        ", which are not supported together");
    };
    for (const json& node : root.value("nodes", json::array())) {
      if (node.contains("skin")) {
        refuse_with("a skin");
      }
      if (node.value("extensions", json::object()).contains(kInstancing)) {
        refuse_with(std::string("instances (") + kInstancing + ")");
      }
    }
    for (const json& view : root.value("bufferViews", json::array())) {
      if (meshopt_of(view) != nullptr) {
        refuse_with(std::string("data compressed with ") + kMeshopt);
      }
    }
    return true;
  } catch (const json::exception&) {
    throw ImportError(kNoStructure);
  }
}

ImportedMesh read_gltf(GltfFile& file) {
  try {
    check_extensions(file.root());
    ImportedMesh mesh = GltfScene(file).read();
    if (mesh.positions.empty()) {
      throw ImportError("it contains no points and no faces");
    }
    return mesh;
  } catch (const json::exception&) {
    throw ImportError(kNoStructure);
  }
}

}  // namespace tactree::builder
