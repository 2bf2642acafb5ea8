#pragma once
// The bodies of a simulation and how they move, from a JSON file:
//
//   {"bodies": [
//     {"blob": 0, "pose": [1,0,0,0.1,  0,1,0,0,  0,0,1,0,  0,0,0,1],
//      "linear_velocity_m_s": [0, 0, 0.01], "angular_velocity_rad_s": [0, 0, 1]},
//     {"blob": "lid.blob", "keyframes": [{"t_s": 0, "pose": [...]}, {"t_s": 2, "pose": [...]}],
//      "from_s": 1, "until_s": 3}]}
//
// "blob": index of a blob on the command line, from 0, or a file next to the scene file. "pose": a
// 4x4 matrix, row by row, in metres, or the name of a pose file next to the scene file; default:
// the scene's origin. If the first body has a pose file, the origin of the scene is that of the
// device. Time 0 is the first tick after arming. A body without "from_s" and "until_s" is always
// enabled.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tactree/simulation/scene_target.hpp"
#include "tactree/support/blob_file.hpp"

namespace tactree::setup {

struct SceneFile {
  std::vector<std::unique_ptr<support::BlobFile>> blobs;   ///< of the user
  std::vector<std::unique_ptr<support::BlobFile>> scaled;  ///< those of bodies in another size
  std::vector<std::string> names;                          ///< of each body's blob
  std::vector<const support::BlobFile*> files;             ///< each body's blob
  std::vector<const support::BlobFile*> given;             ///< each body's blob as the user gave it
  /// Of each body in another size: the index of each point in the blob of the user. Else empty.
  std::vector<std::vector<std::uint32_t>> sources;
  std::vector<std::filesystem::path> read;  ///< all files that the scene names
  std::vector<double> scales;               ///< of each body, relative to the blob of the user
  std::vector<simulation::SceneBody> bodies;
  bool in_device_frame = false;  ///< the origin of the scene is that of the device
};

/// Reads `scene`. If it is empty, each of `blobs` is a body at rest at the origin, or the only one
/// is placed by `pose_file`. Throws UserError with file, key, cause and hint.
[[nodiscard]] SceneFile read_scene(const std::filesystem::path& scene,
                                   const std::vector<std::string>& blobs,
                                   const std::string& pose_file = "");

struct ScaledBlob {
  std::unique_ptr<support::BlobFile> file;
  std::vector<std::uint32_t> sources;  ///< index of each point in the blob that was scaled
};

/// The model at `scale` times its size. `name` is that of messages. Throws UserError.
[[nodiscard]] ScaledBlob scaled_blob(const support::BlobFile& given, const std::string& name,
                                     double scale);

}  // namespace tactree::setup
