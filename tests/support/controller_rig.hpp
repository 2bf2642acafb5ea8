#pragma once
// A controller with a plane and simulated operation.

#include <vector>

#include "analytic_shapes.hpp"
#include "tactree/core/control/controller.hpp"

namespace tactree::test {

/// The plane of all sessions; built once.
inline const Shape& shared_plane() {
  static const Shape shape = plane(0.02);
  return shape;
}

inline bool has_limit(const core::Output& output, core::Limit limit) {
  return (output.status.limits & core::limit_bit(limit)) != 0U;
}

class ControllerRig {
 public:
  explicit ControllerRig(core::Configuration configuration = {},
                         core::HomingMethod homing = core::HomingMethod::kAbsolute) {
    configuration.device.homing = homing;
    status = controller.configure(configuration);
    model_status = controller.load_model(shared_plane().view());
    move(0.0, 0.0, 0.01);
  }

  /// A tick without faults in which the enable line follows at once.
  core::Output step(core::Command command = core::Command::kNone) {
    core::Input now = input;
    now.command = command;
    now.enable_read_back = enable_follows ? enable : input.enable_read_back;
    now.bodies = updates;
    const core::Output output = controller.step(now);
    enable = output.enable;
    input.added_force = {};
    updates.clear();
    return output;
  }

  /// The output of the last of these ticks.
  core::Output rest(int ticks) {
    core::Output output = step();
    for (int i = 1; i < ticks; ++i) {
      output = step();
    }
    return output;
  }

  void move(double x, double y, double z) {
    const double position[core::kAxes] = {x, y, z};
    const core::DeviceModel& device = controller.configuration().device;
    for (std::uint32_t axis = 0; axis < core::kAxes; ++axis) {
      const double counts =
          std::floor(position[axis] * static_cast<double>(device.counts_per_m[axis]));
      input.encoders.counts[axis] =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(counts)) +
                                    static_cast<std::uint32_t>(device.home_count[axis]));
    }
  }

  /// From idle to active.
  void activate() {
    step(core::Command::kArm);
    step();
    input.dead_man = true;
    step();
    if (!controller.configuration().supervision.dead_man_required) {
      step(core::Command::kArm);
    }
  }

  /// Moves straight down to `depth` below the plane at 0.1 m/s; returns the last output.
  core::Output press(double depth) {
    core::Output output = step();
    for (double z = 0.01; z > -depth; z -= 1e-4) {
      move(0.0, 0.0, z);
      output = step();
    }
    return output;
  }

  [[nodiscard]] core::State state() const { return controller.state(); }

  core::Controller controller;
  core::Input input = calm();
  std::vector<core::BodyUpdate> updates;  // of the next step, as input.added_force
  core::ConfigurationStatus status = core::ConfigurationStatus::kOk;
  core::ModelStatus model_status = core::ModelStatus::kOk;
  bool enable = false;
  bool enable_follows = true;

 private:
  static core::Input calm() {
    core::Input input;
    input.emergency_stop = false;
    input.motors_ok = true;
    input.link_alive = true;
    for (bool& valid : input.encoders.valid) {
      valid = true;
    }
    return input;
  }
};

}  // namespace tactree::test
