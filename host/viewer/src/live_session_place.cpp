// The place of the model in front of the device.

#include <nlohmann/json.hpp>
#include <utility>

#include "place_command.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/simulation/workspace.hpp"
#include "tactree/viewer/live_session.hpp"

namespace tactree::viewer {

using nlohmann::json;

core::Vec3 LiveSession::origin_of(const Settings& settings) const {
  return settings.origin_m
             ? *settings.origin_m
             : simulation::middle_at_origin(bodies_.views[0].header(), first_pose_,
                                            device(settings.device).preset.model.kind);
}

Eigen::Vector3d LiveSession::start_of(const Pose& placed) const {
  return placed.value_or(first_pose_) * above_m_;
}

simulation::Placement LiveSession::placement(const Settings& settings, const Pose& placed) const {
  return {simulation::in_device(placed.value_or(first_pose_), origin_of(settings)), settings.scale};
}

LiveSession::Fit LiveSession::check_fit(const Settings& settings, const Pose& placed) const {
  const NamedDevice& used = device(settings.device);
  std::optional<simulation::Placement> wanted;
  if (placed || settings.origin_m) {
    wanted = placement(settings, placed);
  }
  std::optional<std::string> oversize;
  if (placing_.warning) {
    oversize = placing_.warning(used, wanted);
  }
  const bool reaches_start = simulation::reaches_start(
      used.preset.model, start_of(placed) + plant::widen(origin_of(settings)));
  Fit fit = {oversize.value_or(""), oversize.has_value()};
  if (!reaches_start) {
    fit.warning += fit.warning.empty() ? "" : "; ";
    fit.warning +=
        used.name + " does not reach the start of the hand: the probe may begin in the object";
  }
  return fit;
}

std::string LiveSession::named_warning() const {
  const std::string name = bodies_.views[0].header().name;
  return fit_.warning.empty() ? "" : (name.empty() ? "model" : name) + ": " + fit_.warning;
}

std::string LiveSession::warning() const {
  const std::lock_guard lock(mutex_);
  return fit_.warning;
}

void LiveSession::fit() const {
  const std::lock_guard lock(mutex_);
  if (!fit_.is_oversize || !placing_.fit) {
    throw SessionRefused("fit: the device reaches this model already, or it cannot be scaled");
  }
  placing_.fit(device(settings_.device), placement(settings_, placed_));
}

void LiveSession::place(const json& command) {
  const simulation::Placement wanted = placement_of(command);
  Settings settings;
  {
    const std::lock_guard lock(mutex_);
    settings = settings_;
  }
  if (!placing_.renew) {
    throw SessionRefused("place: possible with a single model only (start view without --scene)");
  }
  if (!is_same_scale(wanted.scale, settings.scale)) {
    if (!command.value("restart", false)) {
      throw SessionRefused(
          "a change of the size restarts the simulation without its recorded ticks (add "
          "\"restart\": true)");
    }
    placing_.renew(wanted);
    return;
  }
  const Eigen::Isometry3d pose = simulation::in_scene(wanted.pose, origin_of(settings));
  Fit fit = check_fit(settings, pose);
  const std::lock_guard lock(mutex_);
  placed_ = pose;
  is_moved_ = true;
  fit_ = std::move(fit);
}

json LiveSession::place_json() const {
  const core::Vec3 origin_m = origin_of(settings_);
  const Eigen::Vector3d start_m = start_of(placed_);
  const simulation::Placement now = placement(settings_, placed_);
  return {{"pose", simulation::rows_of(now.pose)},
          {"scale", now.scale},
          {"origin_m", {origin_m.x, origin_m.y, origin_m.z}},
          {"hand_start_m", {start_m.x(), start_m.y(), start_m.z()}}};
}

std::string LiveSession::reach_json() const {
  return viewer::reach_json(device(settings().device).preset.model);
}

}  // namespace tactree::viewer
