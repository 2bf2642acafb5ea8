#pragma once
// A pose file: where a model is in the frame of a device, and its size. The page of `tactree view`
// saves it; build, simulate, view, arm and scenes read it.
//
//   {"pose": [1,0,0,0.01,  0,1,0,0,  0,0,1,-0.02,  0,0,0,1], "scale": 0.8}
//
// device = pose * (scale * model): first the model becomes larger by `scale` about its origin, then
// it is turned and moved by `pose`, a 4x4 matrix, row by row, in metres. "scale" may be omitted: 1.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tactree/simulation/placement.hpp"

namespace tactree::setup {

/// Throws UserError with file, key, cause and hint.
[[nodiscard]] simulation::Placement read_pose_file(const std::filesystem::path& file);

/// The same for the content of such a file; `name` is that of messages.
[[nodiscard]] simulation::Placement placement_of(const nlohmann::json& root,
                                                 const std::string& name);

}  // namespace tactree::setup
