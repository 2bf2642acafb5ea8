#include "tactree/setup/scene_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactree/support/user_error.hpp"

namespace tactree::setup {
namespace {

using nlohmann::json;

// Deviation of a rotation's rows from unit length and right angles that is accepted, because files
// are written by hand.
constexpr double kRotationTolerance = 1e-3;

void require_keys(const json& object, const std::string& place,
                  std::initializer_list<const char*> known) {
  if (!object.is_object()) {
    support::refuse(place, "is not an object", "write it in braces");
  }
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      std::string keys;
      for (const char* name : known) {
        keys += fmt::format("{}{}", keys.empty() ? "" : ", ", name);
      }
      support::refuse(place + "." + key, "is an unknown key", "remove it, or use one of " + keys);
    }
  }
}

double number(const json& value, const std::string& place) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) {
    support::refuse(place, "is not a number", "write a number, without quotes");
  }
  return value.get<double>();
}

std::vector<double> numbers(const json& value, const std::string& place, std::size_t count) {
  if (!value.is_array() || value.size() != count) {
    support::refuse(place, fmt::format("is not a list of {} numbers", count),
                    "write that many numbers");
  }
  std::vector<double> list;
  for (std::size_t i = 0; i < count; ++i) {
    list.push_back(number(value[i], fmt::format("{}[{}]", place, i)));
  }
  return list;
}

Eigen::Vector3d vector(const json& object, const char* key, const std::string& place) {
  if (!object.contains(key)) {
    return Eigen::Vector3d::Zero();
  }
  const std::vector<double> v = numbers(object[key], place + "." + key, 3);
  return {v[0], v[1], v[2]};
}

Eigen::Isometry3d pose(const json& object, const std::string& at) {
  if (!object.contains("pose")) {
    return Eigen::Isometry3d::Identity();
  }
  const std::string place = at + ".pose";
  const std::vector<double> m = numbers(object["pose"], place, 16);
  const Eigen::Matrix4d matrix =
      Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::Matrix3d off = rotation * rotation.transpose() - Eigen::Matrix3d::Identity();
  if (!(off.cwiseAbs().maxCoeff() <= kRotationTolerance) || !(rotation.determinant() > 0.0)) {
    support::refuse(place, "its upper left 3x3 part is not a rotation",
                    "remove scale, shear and mirroring; scale with `tactree build --scale`");
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    support::refuse(place, "its last row is not 0, 0, 0, 1", "write the matrix row by row");
  }
  Eigen::Isometry3d result;
  result.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  result.translation() = matrix.topRightCorner<3, 1>();
  return result;
}

simulation::BodyPath path(const json& body, const std::string& place) {
  try {
    if (!body.contains("keyframes")) {
      return {pose(body, place), vector(body, "linear_velocity_m_s", place),
              vector(body, "angular_velocity_rad_s", place)};
    }
    const json& list = body["keyframes"];
    if (!list.is_array() || body.contains("pose") || body.contains("linear_velocity_m_s") ||
        body.contains("angular_velocity_rad_s")) {
      support::refuse(
          place + ".keyframes", "is not a list, or combined with a pose or velocity",
          "write [{\"t_s\": 0, \"pose\": [...]}, ...], without other keys for the motion");
    }
    std::vector<simulation::Keyframe> keyframes;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string at = fmt::format("{}.keyframes[{}]", place, i);
      require_keys(list[i], at, {"t_s", "pose"});
      keyframes.push_back({number(list[i].value("t_s", json()), at + ".t_s"), pose(list[i], at)});
    }
    return simulation::BodyPath(std::move(keyframes));
  } catch (const std::invalid_argument& error) {
    support::refuse(place, error.what(), "correct its pose, velocities or keyframes");
  }
}

class SceneReader {
 public:
  SceneReader(const std::filesystem::path& file, const std::vector<std::string>& blobs)
      : file_(file) {
    for (const std::string& blob : blobs) {
      given_.push_back(open(blob));
    }
  }

  SceneFile all_at_rest() {
    for (const std::size_t blob : given_) {
      add(blob, {});
    }
    return finish(fmt::format("{} blobs", given_.size()));
  }

  SceneFile read() {
    const std::string name = file_.string();
    const json root = parse();
    require_keys(root, name, {"bodies"});
    const json bodies = root.value("bodies", json());
    if (!bodies.is_array()) {
      support::refuse(name + ": bodies", "is not a list",
                      "write {\"bodies\": [{\"blob\": 0}, ...]}");
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      read_body(bodies[i], fmt::format("{}: bodies[{}]", name, i));
    }
    return finish(name + ": bodies");
  }

 private:
  json parse() const {
    std::ifstream in(file_, std::ios::binary);
    if (!in || std::filesystem::is_directory(file_)) {
      support::refuse(file_.string(), "cannot be read", "give a JSON file");
    }
    try {
      return json::parse(in);
    } catch (const json::exception& error) {
      support::refuse(file_.string(), fmt::format("is not JSON: {}", error.what()),
                      "correct the file there");
    }
  }

  std::size_t open(const std::string& file) {
    const auto known = std::find(files_.begin(), files_.end(), file);
    if (known != files_.end()) {
      return static_cast<std::size_t>(known - files_.begin());
    }
    scene_.blobs.push_back(std::make_unique<support::BlobFile>(file));
    files_.push_back(file);
    return files_.size() - 1;
  }

  std::size_t blob_of(const json& body, const std::string& place) {
    const json blob = body.value("blob", json());
    if (blob.is_string()) {
      return open((file_.parent_path() / blob.get<std::string>()).string());
    }
    if (!blob.is_number_unsigned() || blob.get<std::uint64_t>() >= given_.size()) {
      support::refuse(place + ".blob",
                      fmt::format("is neither a file nor the index of one of the {} blobs given",
                                  given_.size()),
                      "count from 0, or give a file name in quotes");
    }
    return given_[blob.get<std::size_t>()];
  }

  void read_body(const json& body, const std::string& place) {
    require_keys(body, place,
                 {"blob", "pose", "linear_velocity_m_s", "angular_velocity_rad_s", "keyframes",
                  "from_s", "until_s"});
    simulation::SceneBody& added = add(blob_of(body, place), path(body, place));
    if (body.contains("from_s")) {
      added.from_s = number(body["from_s"], place + ".from_s");
    }
    if (body.contains("until_s")) {
      added.until_s = number(body["until_s"], place + ".until_s");
    }
  }

  simulation::SceneBody& add(std::size_t blob, simulation::BodyPath path) {
    scene_.names.push_back(files_[blob]);
    scene_.files.push_back(scene_.blobs[blob].get());
    simulation::SceneBody& body = scene_.bodies.emplace_back();
    body.blob = scene_.blobs[blob]->bytes();
    body.path = std::move(path);
    return body;
  }

  SceneFile finish(const std::string& place) {
    if (scene_.bodies.empty() || scene_.bodies.size() > core::kMaxBodies) {
      support::refuse(
          place,
          fmt::format("{} bodies are outside 1 .. {}", scene_.bodies.size(), core::kMaxBodies),
          "give a number of bodies in that range");
    }
    return std::move(scene_);
  }

  std::filesystem::path file_;
  std::vector<std::string> files_;  // one per blob
  std::vector<std::size_t> given_;  // index of each argument of the command line
  SceneFile scene_;
};

}  // namespace

SceneFile read_scene(const std::filesystem::path& scene, const std::vector<std::string>& blobs) {
  SceneReader reader(scene, blobs);
  return scene.empty() ? reader.all_at_rest() : reader.read();
}

}  // namespace tactree::setup
