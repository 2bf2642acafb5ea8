#pragma once
// The session of `tactree simulate` and of the Python package: device, controller, mechanics and
// path of the hand from what a user gives, and the reason if the controller refuses to start.

#include <Eigen/Geometry>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactree/simulation/simulation.hpp"

namespace tactree::setup {

struct SessionOptions {
  std::string device = "premium";    ///< name of a preset, or file
  std::vector<double> origin_m;      ///< of the model, device frame; empty: see make_setup()
  std::string script = "rub";        ///< motion of the hand
  std::string path;                  ///< file with the path of the hand; empty: the script
  std::string mode = "surface";      ///< or "paper"
  std::optional<float> force_max_N;  ///< default: that of the device
  bool first_force = false;          ///< limits for the first force of a new device
  double seconds = 10.0;             ///< length of the script
  double latency_ticks = 0.0;        ///< age of an encoder reading
  double encoder_step_m = 30e-6;     ///< of a cartesian device: travel of one count
  simulation::Setup setup;           ///< all other parameters
};

/// A body of the session and its pose when the session starts.
struct FirstBody {
  const core::BlobView& view;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  bool in_device_frame = false;  ///< the pose is one in the frame of the device
};

/// Device, controller and mechanics. Options take precedence over the device. If they do not state
/// the origin, it is that of the device for a pose in its frame, else the one of
/// simulation::middle_at_origin(). Throws UserError.
[[nodiscard]] simulation::Setup make_setup(const SessionOptions& options, const FirstBody& body);

/// Path of the hand. A script touches the body at its first pose. Throws std::runtime_error with
/// the place in the file, and std::invalid_argument for an unknown script.
[[nodiscard]] simulation::HandPath hand_path(const SessionOptions& options, const FirstBody& body);

/// Throws UserError unless `start` is ok(). `file` and `view` are those of the refused body. A
/// model that is too slow for a board is described by start.model alone.
void check_start(const std::string& file, const core::BlobView& view,
                 const simulation::Setup& setup, const hal::StartResult& start);

/// Throws UserError that states why the controller did not become active, most often because the
/// hand begins in the object.
[[noreturn]] void refuse_inactive(const std::string& device, const simulation::Setup& setup,
                                  const simulation::Simulation& simulation);

/// The totals of a run, by the names of `tactree simulate --json`, without those of single bodies.
[[nodiscard]] nlohmann::json summary_json(const simulation::Summary& summary);

/// Longest edge of a model that fits the device, for BuildOptions::fit_edge_m. `device` is the name
/// of a preset, or a file. Throws UserError for a device that cannot be read.
[[nodiscard]] std::function<double(const Eigen::Vector3d& size_m)> fit_to_device(
    const std::string& device);

}  // namespace tactree::setup
