#pragma once
// Execution target of the controller: this process, or a board.

#include "tactree/core/control/controller.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/sim/board.hpp"

namespace tactree::simulation {

/// A controller with its loop. It accesses the device through the simulated board; all calls must
/// pass the same board.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// Configures the controller and loads its model. Call it once, before the first tick.
  virtual hal::StartResult start(hal::sim::SimBoard& board,
                                 const core::Configuration& configuration) = 0;
  /// Executes one tick: from the board's encoders to its motors.
  virtual core::Status tick(hal::sim::SimBoard& board) = 0;
  /// Call after the last tick.
  virtual void finish() {}
};

/// Controller in this process with the model in the board's storage.
class HostTarget : public Target {
 public:
  hal::StartResult start(hal::sim::SimBoard& board,
                         const core::Configuration& configuration) override {
    return hal::Loop(board, controller_).start(configuration);
  }
  core::Status tick(hal::sim::SimBoard& board) override {
    return hal::Loop(board, controller_).tick().status;
  }

 private:
  core::Controller controller_;
};

}  // namespace tactree::simulation
