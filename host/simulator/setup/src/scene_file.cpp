#include "tactree/setup/scene_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "json_values.hpp"
#include "tactree/builder/scaled_model.hpp"
#include "tactree/setup/pose_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::setup {
namespace {

using nlohmann::json;

/// Places a body whose pose is a matrix, or a file next to the scene file.
struct PoseReader {
  std::filesystem::path folder;
  std::vector<std::filesystem::path>* files;  // that it has read

  [[nodiscard]] bool names_file(const json& object) const {
    return object.contains("pose") && object["pose"].is_string();
  }
  [[nodiscard]] simulation::Placement operator()(const json& object,
                                                 const std::string& place) const {
    if (names_file(object)) {
      files->push_back(folder / object["pose"].get<std::string>());
      return read_pose_file(files->back());
    }
    return {object.contains("pose") ? pose(object["pose"], place + ".pose")
                                    : Eigen::Isometry3d::Identity(),
            1.0};
  }
};

/// Of a keyframe, between which a body keeps its size.
Eigen::Isometry3d rigid_pose(const json& object, const std::string& place, const PoseReader& read) {
  const simulation::Placement placement = read(object, place);
  if (placement.scale != 1.0) {
    support::refuse(place + ".pose",
                    fmt::format("its file has the scale {:.6g}, and a body keeps its size while it "
                                "moves",
                                placement.scale),
                    "remove \"scale\" from the file, and build the model with --scale");
  }
  return placement.pose;
}

simulation::BodyPath path(const json& body, const std::string& place,
                          const Eigen::Isometry3d& first, const PoseReader& read) {
  try {
    if (!body.contains("keyframes")) {
      return {first, vector(body, "linear_velocity_m_s", place),
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
      keyframes.push_back(
          {number(list[i].value("t_s", json()), at + ".t_s"), rigid_pose(list[i], at, read)});
    }
    return simulation::BodyPath(std::move(keyframes));
  } catch (const std::invalid_argument& error) {
    support::refuse(place, error.what(), "correct its pose, velocities or keyframes");
  }
}

class SceneReader {
 public:
  SceneReader(const std::filesystem::path& file, const std::vector<std::string>& blobs)
      : file_(file), read_pose_{file.parent_path(), &scene_.read} {
    for (const std::string& blob : blobs) {
      given_.push_back(open(blob));
    }
  }

  SceneFile all_at_rest() {
    for (const std::size_t blob : given_) {
      add(blob, {}, 1.0);
    }
    return finish(fmt::format("{} blobs", given_.size()));
  }

  SceneFile placed(const std::string& pose_file) {
    if (given_.size() != 1) {
      support::refuse("--pose", fmt::format("it places one model, and {} are given", given_.size()),
                      "give one BLOB, or write the file as \"pose\" of each body of a --scene");
    }
    const simulation::Placement placement = read_pose_file(pose_file);
    add(given_[0], simulation::BodyPath(placement.pose), placement.scale);
    scene_.in_device_frame = true;
    return finish("1 blob");
  }

  SceneFile read() {
    const std::string name = file_.string();
    const json root = parse_file(file_);
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
  std::size_t open(const std::string& file) {
    const auto known = std::find(files_.begin(), files_.end(), file);
    if (known != files_.end()) {
      return static_cast<std::size_t>(known - files_.begin());
    }
    scene_.blobs.push_back(std::make_unique<support::BlobFile>(file));
    files_.push_back(file);
    scene_.read.emplace_back(file);
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
    const simulation::Placement first = read_pose_(body, place);
    simulation::SceneBody& added =
        add(blob_of(body, place), path(body, place, first.pose, read_pose_), first.scale);
    scene_.in_device_frame =
        scene_.in_device_frame || (scene_.bodies.size() == 1 && read_pose_.names_file(body));
    if (body.contains("from_s")) {
      added.from_s = number(body["from_s"], place + ".from_s");
    }
    if (body.contains("until_s")) {
      added.until_s = number(body["until_s"], place + ".until_s");
    }
    if (!(added.from_s < added.until_s)) {
      support::refuse(place, "ends (until_s) before it begins (from_s)", "exchange the two times");
    }
  }

  simulation::SceneBody& add(std::size_t blob, simulation::BodyPath path, double scale) {
    scene_.names.push_back(files_[blob]);
    scene_.given.push_back(scene_.blobs[blob].get());
    scene_.sources.emplace_back();
    scene_.files.push_back(scaled(blob, scale));
    scene_.scales.push_back(scale);
    simulation::SceneBody& body = scene_.bodies.emplace_back();
    body.blob = scene_.files.back()->bytes();
    body.path = std::move(path);
    return body;
  }

  const support::BlobFile* scaled(std::size_t blob, double scale) {
    const support::BlobFile& given = *scene_.blobs[blob];
    if (scale == 1.0) {
      return &given;
    }
    ScaledBlob made = scaled_blob(given, files_[blob], scale);
    scene_.sources.back() = std::move(made.sources);
    return scene_.scaled.emplace_back(std::move(made.file)).get();
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

  SceneFile scene_;
  std::filesystem::path file_;
  PoseReader read_pose_;
  std::vector<std::string> files_;  // one per blob of the user
  std::vector<std::size_t> given_;  // index of each argument of the command line
};

}  // namespace

ScaledBlob scaled_blob(const support::BlobFile& given, const std::string& name, double scale) {
  builder::WrittenBlob scaled;
  try {
    scaled = builder::scaled_model(given.view(), scale);
  } catch (const std::runtime_error& error) {
    support::refuse(name, fmt::format("cannot be scaled by {:.6g}: {}", scale, error.what()),
                    "choose another scale");
  }
  return {std::make_unique<support::BlobFile>(support::BlobFile::copy_of(scaled.bytes, name)),
          std::move(scaled.source_index)};
}

SceneFile read_scene(const std::filesystem::path& scene, const std::vector<std::string>& blobs,
                     const std::string& pose_file) {
  SceneReader reader(scene, blobs);
  if (!pose_file.empty()) {
    return reader.placed(pose_file);
  }
  return scene.empty() ? reader.all_at_rest() : reader.read();
}

}  // namespace tactree::setup
