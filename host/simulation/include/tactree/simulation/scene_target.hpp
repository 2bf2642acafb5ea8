#pragma once
// Controllers with bodies that move: several in this process, or the one of another target.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "tactree/simulation/body_path.hpp"
#include "tactree/simulation/target.hpp"

namespace tactree::simulation {

struct SceneBody {
  /// 4-byte aligned, outlives the target. Of the first body: the one in the board's storage.
  std::span<const std::byte> blob;
  BodyPath path{};
  double from_s = -std::numeric_limits<double>::infinity();  ///< enabled from then
  double until_s = std::numeric_limits<double>::infinity();  ///< to then
};

/// What the controller is told of a body at a time.
[[nodiscard]] hal::BodyUpdate update_at(const SceneBody& body, std::uint32_t number, double t_s);

class SceneTarget : public Target {
 public:
  /// At least one body. Time begins after `ticks_before` ticks: Simulation::arming_ticks().
  SceneTarget(std::vector<SceneBody> bodies, std::uint64_t ticks_before);

  /// The result of the first body that was refused, if any was; see refused_body().
  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  core::Status tick(hal::sim::SimBoard& board) override;

  [[nodiscard]] std::size_t refused_body() const { return refused_body_; }
  [[nodiscard]] core::Controller& controller() { return controller_; }

 private:
  [[nodiscard]] hal::StartResult add(const SceneBody& body, std::uint32_t& number);
  void move_bodies(double t_s);

  std::vector<SceneBody> bodies_;
  std::vector<std::uint32_t> numbers_;  // of the bodies in the controller
  core::Controller controller_;
  double period_s_ = 0.0;
  double tick_ = 0.0;
  std::size_t refused_body_ = 0;
};

/// Moves the one body of another target, in each tick over the link; so it may be on a board. When
/// the link is cut the body moves on as it was last told.
class LinkedBodyTarget : public Target {
 public:
  /// As SceneTarget.
  LinkedBodyTarget(std::unique_ptr<Target> target, SceneBody body, std::uint64_t ticks_before);

  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  core::Status tick(hal::sim::SimBoard& board) override;
  void finish() override { target_->finish(); }

 private:
  std::unique_ptr<Target> target_;
  SceneBody body_;
  double period_s_ = 0.0;
  double tick_ = 0.0;
};

}  // namespace tactree::simulation
