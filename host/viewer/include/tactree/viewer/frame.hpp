#pragma once
// The content of a frame as JSON: the latest tick, and minimum and maximum values over the ticks
// since the last frame.

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactree/core/contact/surface.hpp"
#include "tactree/simulation/scene_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::viewer {

/// Minimum and maximum over the ticks of a frame, so that no spike is lost.
struct Span {
  double low = 0.0;
  double high = 0.0;
  bool empty = true;
  void add(double value);
};

/// The ticks since the last frame.
class Strip {
 public:
  void add(const core::Status& status);
  /// Work of the tick, in the unit of Work.
  void add_work(double work) { work_.add(work); }
  /// Returns the collected values and clears them.
  [[nodiscard]] nlohmann::json take();

 private:
  Span force_N_;
  Span penetration_m_;
  Span work_;
  std::uint64_t ticks_ = 0;
};

/// The bodies of the scene and their models, in the same order.
struct Bodies {
  std::vector<core::BlobView> views;
  std::vector<simulation::SceneBody> bodies;
  std::vector<std::string> notes = {};  ///< about each model, for the page; may be shorter
};

/// A tick of one controller. "about" of a fault states its cause and remedy, "note" why there is no
/// force although the controller is active; usually empty. `joints` are the joint positions of the
/// device; if empty, they are computed from the tip. `scratch` is working memory.
[[nodiscard]] nlohmann::json run_json(const simulation::Sample& sample, const char* mode,
                                      const core::DeviceModel& device,
                                      const core::Vec3& model_origin_m,
                                      const std::optional<Eigen::Vector3d>& joints,
                                      const Bodies& bodies, core::CandidateSet& scratch);

/// Unit and bound of the work per tick. The unit is empty if the work is unknown. `why` states the
/// cause of a missing unit or bound.
struct Work {
  std::string unit;
  double per_period = 0.0;  ///< work that fills one period
  std::optional<double> bound;
  std::string why;
};
[[nodiscard]] nlohmann::json work_json(const Work& work);
/// For a source that does not report the work.
[[nodiscard]] nlohmann::json unknown_work(const std::string& why);

/// Name and number of points of each model.
[[nodiscard]] nlohmann::json models_json(const Bodies& bodies);
[[nodiscard]] bool has_materials(const Bodies& bodies);

/// The pose of each body at time t_s: 12 numbers, the upper three rows of its matrix.
[[nodiscard]] nlohmann::json poses_json(const Bodies& bodies, double t_s);

/// The border of the workspace for drawings, device frame: {"rows": n, "columns": m, "points_m":
/// [[x, y, z], ...]}, see simulation::reach_shape(). Cost: some tenths of a second.
[[nodiscard]] std::string reach_json(const core::DeviceModel& device);

}  // namespace tactree::viewer
