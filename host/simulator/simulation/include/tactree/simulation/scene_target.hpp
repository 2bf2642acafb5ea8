#pragma once
// Targets with moving bodies: several bodies in this process, or the single body of another target.

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
  /// 4-byte aligned; must outlive the target. For the first body, the blob in the board's storage.
  std::span<const std::byte> blob;
  BodyPath path{};
  double from_s = -std::numeric_limits<double>::infinity();  ///< start of the enabled time
  double until_s = std::numeric_limits<double>::infinity();  ///< end of the enabled time
};

/// Update of a body at a time. The controller ignores a pose that core::is_valid() refuses; a body
/// that leaves the accepted range therefore stops at its boundary.
[[nodiscard]] hal::BodyUpdate update_at(const SceneBody& body, std::uint32_t number, double t_s);

class SceneTarget : public Target {
 public:
  /// Throws std::invalid_argument without a body. Time 0 is after `ticks_before` ticks; see
  /// Simulation::arming_ticks().
  SceneTarget(std::vector<SceneBody> bodies, std::uint64_t ticks_before);

  /// Returns the result of the first refused body, if any; see refused_body().
  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override;
  core::Status tick(hal::sim::SimBoard& board) override;

  /// Changes the running controller between two ticks; see Controller::adjust().
  [[nodiscard]] core::ConfigurationStatus adjust(hal::sim::SimBoard& board,
                                                 const core::Adjustment& adjustment);
  /// From the next tick on, a body is at rest at `pose`, which core::is_valid() accepts.
  /// Precondition: body is the index of one of the bodies.
  void place(std::size_t body, const Eigen::Isometry3d& pose) {
    bodies_[body].path = BodyPath(pose);
  }
  /// The next tick is this one of the bodies' paths, counted from time 0.
  void go_to(std::uint64_t tick) { tick_ = static_cast<double>(tick); }

  [[nodiscard]] std::size_t refused_body() const { return refused_body_; }
  [[nodiscard]] core::Controller& controller() { return controller_; }

 private:
  [[nodiscard]] hal::StartResult add(hal::sim::SimBoard& board, const SceneBody& body,
                                     std::uint32_t& number);
  void move_bodies(hal::sim::SimBoard& board, double t_s);

  std::vector<SceneBody> bodies_;
  std::vector<std::uint32_t> numbers_;    // of the bodies in the controller
  std::vector<hal::BodyUpdate> updates_;  // of the current tick
  core::Controller controller_;
  double period_s_ = 0.0;
  double tick_ = 0.0;
  std::size_t refused_body_ = 0;
};

/// Moves the single body of another target, which may be a board, over the link in each tick. If
/// the link is cut, the body continues with the motion of the last update.
class LinkedBodyTarget : public Target {
 public:
  /// `ticks_before` as for SceneTarget.
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
