#pragma once
// The control loop: transfers data between a board and the controller, which makes all decisions.
// start() and tick() are called from one context.
//
//   MyBoard board;
//   core::Controller controller;
//   hal::Loop loop(board, controller);
//   if (!loop.start(configuration).ok()) { /* report it; tick() keeps the motors off */ }
//   while (true) loop.tick();

#include "tactree/core/control/between_ticks.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/model/blob.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/start_result.hpp"

namespace tactree::hal {

/// Supply of the amplifiers, V; 0 if the board does not measure it.
template <Board B>
[[nodiscard]] float supply_V(B& board) {  // NOLINT(readability-identifier-naming): as in Readings
  if constexpr (requires { board.motors().supply_V(); }) {
    return board.motors().supply_V();
  } else {
    return 0.0F;
  }
}

/// Waits for the tick, then reads all of its inputs except the link and the load.
template <Board B>
[[nodiscard]] core::Input read_inputs(B& board) {
  const Tick tick = board.ticker().wait();
  return {{.encoders = board.encoders().read(),
           .emergency_stop = board.safety_inputs().emergency_stop(),
           .dead_man = board.safety_inputs().dead_man(),
           .enable_read_back = board.enable_line().read_back(),
           .motors_ok = board.motors().healthy(),
           .overruns = tick.overruns,
           .supply_V = supply_V(board)}};
}

template <Board B>
class Loop {
 public:
  Loop(B& board, core::Controller& controller) : board_(board), controller_(controller) {}

  /// Configures the controller and loads the model from the board's storage. The duration is not
  /// bounded by a tick: call it before the first tick. If the configuration or the model is
  /// refused, the state stays boot or no-model.
  [[nodiscard]] StartResult start(const core::Configuration& configuration) {
    board_.enable_line().set(false);
    StartResult result;
    core::Uninterrupted before_ticks(board_);
    core::BetweenTicks changes(controller_, before_ticks);
    result.configuration = changes.configure(configuration);
    if (result.configuration != core::ConfigurationStatus::kOk) {
      return result;
    }
    core::BlobView view;
    result.blob = core::open_blob(board_.storage().active(), view);
    if (result.blob == core::BlobStatus::kOk) {
      result.model = changes.load_model(view);
    }
    return result;
  }

  /// Executes one tick: waits, reads, steps, writes. Returns the output of the controller. Not
  /// inlined, because a fault injection test skips each of its instructions.
  [[gnu::noinline]] const core::Output& tick() {
    core::Input input = read_inputs(board_);
    input.load = load_;
    listen(input);

    const std::uint32_t begin_us = board_.ticker().now_us();
    const core::Output& output = controller_.step(input);
    core::report_to_recorder(board_, [&](auto& recorder) { recorder.stepped(input, output); });
    const bool active = controller_.may_give_force();  // second check, see may_give_force()
    board_.motors().write(active ? output.motors : core::SafetyGate::no_effort());
    board_.enable_line().set(output.enable);
    board_.link().send(output.status);
    const std::uint32_t took_us = board_.ticker().now_us() - begin_us;
    load_ = static_cast<float>(took_us) * 1e-6F * controller_.configuration().rate_hz;
    return output;
  }

 private:
  /// A separate function, so the message occupies no stack during the controller's step.
  void listen(core::Input& input) {
    const LinkInput link = board_.link().receive();
    input.link_alive = link.alive;
    input.link_age_ticks = link.age_ticks;
    input.command = link.command;
    input.bodies = link.bodies;
    input.added_force = link.added_force;
    input.storage_busy = link.storage_busy;
  }

  B& board_;
  core::Controller& controller_;
  float load_ = 0.0F;  // of the last tick
};

}  // namespace tactree::hal
