#pragma once
// What a page shows of one tick, and of the ticks since the frame before, as JSON.

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tactree/core/surface.hpp"
#include "tactree/simulation/scene_target.hpp"
#include "tactree/simulation/simulation.hpp"

namespace tactree::viewer {

/// Lowest and highest of a figure over the ticks of a frame, so that no spike is lost.
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
  /// How much the tick had to do, in the unit that the source tells.
  void add_work(double work) { work_.add(work); }
  /// Takes what was added, and begins anew.
  [[nodiscard]] nlohmann::json take();

 private:
  Span force_N_;
  Span penetration_m_;
  Span work_;
  std::uint64_t ticks_ = 0;
};

/// The bodies, to place a contact's points.
struct Bodies {
  std::vector<core::BlobView> views;
  std::vector<simulation::SceneBody> bodies;
};

/// A tick of one controller. `joints`: of the device; empty: found from the tip. `scratch` is for
/// the points gathered around the contact.
[[nodiscard]] nlohmann::json run_json(const simulation::Sample& sample, const char* mode,
                                      const core::DeviceModel& device,
                                      const core::Vec3& model_origin_m,
                                      const std::optional<Eigen::Vector3d>& joints,
                                      const Bodies& bodies, core::CandidateSet& scratch);

/// What a strip's work is counted in, and the most that a tick can take where that is known; `why`
/// not, else. Without a unit there is no work to be shown.
struct Work {
  std::string unit;
  double per_period = 0.0;  ///< what fills a tick's period
  std::optional<double> bound;
  std::string why;
};
[[nodiscard]] nlohmann::json work_json(const Work& work);
/// Of a source that does not tell it.
[[nodiscard]] nlohmann::json unknown_work(const std::string& why);

/// Names and sizes.
[[nodiscard]] nlohmann::json models_json(const Bodies& bodies);
[[nodiscard]] bool has_materials(const Bodies& bodies);

/// Each body's pose at a time: 12 numbers, the upper rows of its matrix.
[[nodiscard]] nlohmann::json poses_json(const Bodies& bodies, double t_s);

}  // namespace tactree::viewer
