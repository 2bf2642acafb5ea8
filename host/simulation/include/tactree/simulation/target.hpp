#pragma once
// Where the controller runs: in this process, or on a board.

#include "tactree/core/controller.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/sim/board.hpp"

namespace tactree::simulation {

/// A controller together with its loop. It sees the device through the simulated board it is given,
/// always the same one.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// Configures the controller and gives it its model. Once, before the first tick.
  virtual hal::StartResult start(hal::sim::SimBoard& board,
                                 const core::Configuration& configuration) = 0;
  /// One tick: from the board's encoders to its motors.
  virtual core::Status tick(hal::sim::SimBoard& board) = 0;
  /// After the last tick.
  virtual void finish() {}
};

/// In this process; the model is the one in the board's storage.
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
