#pragma once
// The control loop: moves data between a board and the controller, and decides nothing.
//
//   MyBoard board;
//   core::Controller controller;
//   hal::Loop loop(board, controller);
//   if (!loop.start(configuration).ok()) { /* tell, and stay: tick() keeps the motors off */ }
//   while (true) loop.tick();

#include "tactree/core/blob.hpp"
#include "tactree/core/controller.hpp"
#include "tactree/hal/board.hpp"

namespace tactree::hal {

/// What the self-test of the program found.
enum class ImageStatus : std::uint8_t {
  kOk = 0,
  kDamaged,    ///< a byte of it is not as it was built
  kBadMemory,  ///< a bit of the RAM of its variables does not hold
};

/// Why there is no model to touch.
struct StartResult {
  core::ConfigurationStatus configuration = core::ConfigurationStatus::kOk;
  core::BlobStatus blob = core::BlobStatus::kOk;
  core::ModelStatus model = core::ModelStatus::kOk;
  ImageStatus image = ImageStatus::kOk;  ///< filled in by the firmware, ahead of Loop::start()
  [[nodiscard]] bool ok() const {
    return configuration == core::ConfigurationStatus::kOk && blob == core::BlobStatus::kOk &&
           model == core::ModelStatus::kOk && image == ImageStatus::kOk;
  }
};

/// What the controller refuses of an update stays as it is. Cost: constant.
inline void apply(const BodyUpdate& update, core::Controller& controller) {
  if (update.body != core::kNoBody) {
    (void)controller.move_body(update.body, update.pose, update.motion);
    (void)controller.enable_body(update.body, update.enabled);
  }
}

/// What a tick reads, in its order: waits for the tick first. All but the link and the load.
template <Board B>
[[nodiscard]] core::Input read_inputs(B& board) {
  const Tick tick = board.ticker().wait();
  core::Input input;
  input.encoders = board.encoders().read();
  input.emergency_stop = board.safety_inputs().emergency_stop();
  input.dead_man = board.safety_inputs().dead_man();
  input.enable_read_back = board.enable_line().read_back();
  input.motors_ok = board.motors().healthy();
  input.overruns = tick.overruns;
  if constexpr (requires { board.motors().supply_V(); }) {
    input.supply_V = board.motors().supply_V();
  }
  return input;
}

template <Board B>
class Loop {
 public:
  Loop(B& board, core::Controller& controller) : board_(board), controller_(controller) {}

  /// Configures the controller and gives it the model in the board's storage. Not bounded by a
  /// tick: call it before the first. The state stays boot or no-model when something is refused.
  [[nodiscard]] StartResult start(const core::Configuration& configuration) {
    board_.enable_line().set(false);
    StartResult result;
    result.configuration = controller_.configure(configuration);
    if (result.configuration != core::ConfigurationStatus::kOk) {
      return result;
    }
    core::BlobView view;
    result.blob = core::open_blob(board_.storage().active(), view);
    if (result.blob == core::BlobStatus::kOk) {
      result.model = controller_.load_model(view);
    }
    return result;
  }

  /// One tick: waits for it, reads, steps, writes. Returns what the controller said. A function of
  /// its own, so that each of its instructions can be left out in a test.
  [[gnu::noinline]] const core::Output& tick() {
    core::Input input = read_inputs(board_);
    input.load = load_;
    listen(input);

    const std::uint32_t begin_us = board_.ticker().now_us();
    const core::Output& output = controller_.step(input);
    const bool active = controller_.may_give_force();  // again: see there
    board_.motors().write(active ? output.motors : core::SafetyGate::no_effort());
    board_.enable_line().set(output.enable);
    board_.link().send(output.status);
    const std::uint32_t took_us = board_.ticker().now_us() - begin_us;
    load_ = static_cast<float>(took_us) * 1e-6F * controller_.configuration().rate_hz;
    return output;
  }

 private:
  /// A function of its own: a message takes no stack while the controller steps.
  void listen(core::Input& input) {
    const LinkInput link = board_.link().receive();
    input.link_alive = link.alive;
    input.link_age_ticks = link.age_ticks;
    input.command = link.command;
    apply(link.body, controller_);
    if (link.force_ticks > 0U) {
      controller_.add_force(link.force_N, link.force_ticks);
    }
    if (link.storage_busy && controller_.motors_off()) {
      input.overruns = 0;
    }
  }

  B& board_;
  core::Controller& controller_;
  float load_ = 0.0F;  // of the last tick
};

}  // namespace tactree::hal
