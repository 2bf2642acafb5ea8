#pragma once
// Receives all inputs of a controller in order: each Input, and each accepted change between two
// ticks. The same sequence produces bit-identical outcomes. Called from the context of the loop.

#include "tactree/core/control/controller.hpp"

namespace tactree::hal::sim {

/// Result of a tick, from a controller in this process or on a board.
struct TickOutcome {
  float effort[core::kAxes] = {};  ///< N or Nm
  bool enable = false;
  const core::Status& status;
};

class SessionRecorder {
 public:
  SessionRecorder() = default;
  virtual ~SessionRecorder() = default;
  SessionRecorder(const SessionRecorder&) = delete;
  SessionRecorder& operator=(const SessionRecorder&) = delete;

  virtual void configured(const core::Configuration& configuration) = 0;
  virtual void adjusted(const core::Adjustment& adjustment) = 0;
  /// Replaces all bodies. The view is valid during the call.
  virtual void model_loaded(const core::BlobView& view) = 0;
  virtual void body_added(const core::BlobView& view, const core::Pose& pose) = 0;
  virtual void body_removed(std::uint32_t number) = 0;
  /// Removes all bodies.
  virtual void model_unloaded() = 0;
  /// Called after each tick.
  virtual void ticked(const core::Input& input, const TickOutcome& outcome) = 0;
  void stepped(const core::Input& input, const core::Output& output) {
    const core::MotorCommand& motors = output.motors;
    ticked(input,
           {{motors.effort(0), motors.effort(1), motors.effort(2)}, output.enable, output.status});
  }
};

}  // namespace tactree::hal::sim
