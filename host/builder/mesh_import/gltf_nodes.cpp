#include "mesh_import/gltf_nodes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

namespace tactree::builder {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using nlohmann::json;

struct Placement {
  Vector3d translation = Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vector3d scale = Vector3d::Ones();

  [[nodiscard]] Matrix4d matrix() const {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    transform.translate(translation).rotate(rotation.normalized()).scale(scale);
    return transform.matrix();
  }
};

Vector3d vector_at(const std::vector<double>& numbers, std::size_t first = 0) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

Eigen::Quaterniond rotation_at(const std::vector<double>& numbers, std::size_t first = 0) {
  return {numbers[first + 3], numbers[first], numbers[first + 1], numbers[first + 2]};
}

std::vector<double> numbers_of(const json& object, const char* name, std::size_t count) {
  const auto found = object.find(name);
  if (found == object.end()) {
    return {};
  }
  auto numbers = found->get<std::vector<double>>();
  if (numbers.size() != count) {
    throw ImportError(std::string("the \"") + name + "\" of a node does not have " +
                      std::to_string(count) + " numbers");
  }
  return numbers;
}

Matrix4d transform_of(const json& node) {
  if (const auto m = numbers_of(node, "matrix", 16); !m.empty()) {
    return Eigen::Map<const Matrix4d>(m.data());
  }
  Placement placement;
  if (const auto t = numbers_of(node, "translation", 3); !t.empty()) {
    placement.translation = vector_at(t);
  }
  if (const auto r = numbers_of(node, "rotation", 4); !r.empty()) {
    placement.rotation = rotation_at(r);
  }
  if (const auto s = numbers_of(node, "scale", 3); !s.empty()) {
    placement.scale = vector_at(s);
  }
  return placement.matrix();
}

std::vector<std::size_t> numbers_of_nodes(const json& object, const char* list = "children") {
  std::vector<std::size_t> nodes;
  for (const json& node : object.value(list, json::array())) {
    nodes.push_back(node.is_number_unsigned() ? node.get<std::size_t>() : kNoIndex);
  }
  return nodes;
}

/// Together with the nodes below it.
bool is_hidden(const json& node) {
  const json extensions = node.value("extensions", json::object());
  return !extensions.value("KHR_node_visibility", json::object()).value("visible", true);
}

/// The transforms of the instances in the frame of the node. Of the attributes that place them,
/// each has one entry per instance.
std::vector<Matrix4d> instances_of(const json& extension, GltfFile& file) {
  const json attributes = extension.value("attributes", json::object());
  const auto read = [&](const char* name, std::size_t width) {
    return attributes.contains(name) ? file.numbers(gltf_count(attributes, name), width)
                                     : std::vector<double>{};
  };
  const std::vector<double> translations = read("TRANSLATION", 3);
  const std::vector<double> rotations = read("ROTATION", 4);
  const std::vector<double> scales = read("SCALE", 3);
  const std::size_t count =
      std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
  if (translations.empty() && rotations.empty() && scales.empty()) {
    return {Matrix4d::Identity()};  // the attributes are of another kind, such as numbers
  }
  std::vector<Matrix4d> instances;
  for (std::size_t i = 0; i < count; ++i) {
    Placement placement;
    const auto has = [&](const std::vector<double>& numbers, std::size_t width) {
      if (!numbers.empty() && numbers.size() != width * count) {
        throw ImportError(std::string("the attributes of ") + kInstancing +
                          " do not have one entry per instance");
      }
      return !numbers.empty();
    };
    if (has(translations, 3)) {
      placement.translation = vector_at(translations, 3 * i);
    }
    if (has(rotations, 4)) {
      placement.rotation = rotation_at(rotations, 4 * i);
    }
    if (has(scales, 3)) {
      placement.scale = vector_at(scales, 3 * i);
    }
    instances.push_back(placement.matrix());
  }
  return instances;
}

}  // namespace

GltfNodes::GltfNodes(GltfFile& file) : file_(file) {
  find_parents();
  worlds_.assign(parents_.size(), std::nullopt);
  for (std::size_t i = 0; i < parents_.size(); ++i) {
    place(i);
  }
  find_shown();
}

void GltfNodes::find_parents() {
  const std::size_t count = file_.root().value("nodes", json::array()).size();
  parents_.assign(count, kNoIndex);
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::size_t child : numbers_of_nodes(file_.at("nodes", i))) {
      if (child >= count || parents_[child] != kNoIndex) {
        throw ImportError("its nodes do not form a tree");
      }
      parents_[child] = i;
    }
  }
}

/// Iterative, because a long chain of nodes would exhaust the stack of a recursion.
void GltfNodes::place(std::size_t number) {
  std::vector<std::size_t> chain;
  for (std::size_t at = number; at != kNoIndex && !worlds_[at]; at = parents_[at]) {
    chain.push_back(at);
    if (chain.size() > parents_.size()) {
      throw ImportError("its nodes do not form a tree");
    }
  }
  while (!chain.empty()) {
    const std::size_t at = chain.back();
    chain.pop_back();
    const Matrix4d own = transform_of(file_.at("nodes", at));
    worlds_[at] = parents_[at] == kNoIndex ? own : Matrix4d(*worlds_[parents_[at]] * own);
  }
}

void GltfNodes::find_shown() {
  std::vector<std::size_t> open;
  if (file_.root().contains("scenes")) {
    open = numbers_of_nodes(file_.at("scenes", gltf_count(file_.root(), "scene", 0)), "nodes");
    std::reverse(open.begin(), open.end());
  } else {
    for (std::size_t i = parents_.size(); i > 0; --i) {
      if (parents_[i - 1] == kNoIndex) {
        open.push_back(i - 1);
      }
    }
  }
  std::vector<bool> found(parents_.size(), false);
  while (!open.empty()) {
    const std::size_t number = open.back();
    open.pop_back();
    const json& node = file_.at("nodes", number);
    if (found[number]) {
      continue;
    }
    if (is_hidden(node)) {
      ++hidden_;
      continue;
    }
    found[number] = true;
    shown_.push_back(number);
    const std::vector<std::size_t> children = numbers_of_nodes(node);
    open.insert(open.end(), children.rbegin(), children.rend());
  }
}

std::vector<Matrix4d> GltfNodes::places(std::size_t number) const {
  const json& node = file_.at("nodes", number);
  const json extensions = node.value("extensions", json::object());
  if (!extensions.contains(kInstancing)) {
    return {*worlds_[number]};
  }
  if (node.contains("skin")) {
    throw ImportError(std::string("it has a skin with ") + kInstancing +
                      ", which are not supported together");
  }
  std::vector<Matrix4d> places = instances_of(extensions[kInstancing], file_);
  for (Matrix4d& place : places) {
    place = *worlds_[number] * place;
  }
  return places;
}

std::vector<Matrix4d> GltfNodes::joints(std::size_t number) const {
  const json& node = file_.at("nodes", number);
  if (!node.contains("skin")) {
    return {};
  }
  const json& skin = file_.at("skins", gltf_count(node, "skin"));
  std::vector<Matrix4d> joints;
  for (const std::size_t joint : numbers_of_nodes(skin, "joints")) {
    if (joint >= worlds_.size()) {
      throw ImportError("a joint of a skin is not one of its nodes");
    }
    joints.push_back(*worlds_[joint]);
  }
  if (!skin.contains("inverseBindMatrices")) {
    return joints;
  }
  const std::vector<double> inverse = file_.numbers(gltf_count(skin, "inverseBindMatrices"), 16);
  if (inverse.size() < 16 * joints.size()) {
    throw ImportError("a skin has more joints than inverseBindMatrices");
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    joints[i] *= Eigen::Map<const Matrix4d>(inverse.data() + 16 * i);
  }
  return joints;
}

}  // namespace tactree::builder
