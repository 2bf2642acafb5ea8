#include "arm_command.hpp"

#include <fmt/format.h>

#include <memory>
#include <thread>

#include "board_port.hpp"
#include "command.hpp"
#include "interruption.hpp"
#include "tactree/core/controller.hpp"

namespace tactree::cli {
namespace {

struct ArmOptions {
  BoardPort port;
  double patience_s = 30.0;
  double seconds = 0.0;
  int link_timeout_ms = 50;
  bool clear = false;
  bool home = false;
};

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

/// Until the time is up, somebody interrupts, or the board stops.
void stay(host::Board& board, double seconds, int& exit_code) {
  const auto begin = std::chrono::steady_clock::now();
  while (!interrupted() &&
         (seconds <= 0.0 || std::chrono::steady_clock::now() - begin < milliseconds(seconds))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const core::wire::StateReply state = board.state();
    if (static_cast<core::State>(state.state) != core::State::kActive) {
      fmt::print("the board is in state {}\n",
                 core::name_of(static_cast<core::State>(state.state)));
      exit_code = kExitFailed;
      return;
    }
  }
}

// The session needs its link: when this program ends, however, so does the force.
void arm(const ArmOptions& options, int& exit_code) {
  watch_interruption();
  host::Board board(chosen_port(options.port),
                    {options.port.baud, static_cast<std::uint16_t>(options.link_timeout_ms)});
  if (options.clear) {
    board.clear_faults();
  }
  if (options.home) {
    board.home();
  }
  board.arm(milliseconds(options.patience_s));
  fmt::print("active; ends with this program\n");
  std::fflush(stdout);
  stay(board, options.seconds, exit_code);
  board.stop();
  fmt::print("stopped\n");
}

}  // namespace

void add_arm_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ArmOptions>();
  CLI::App* verb =
      app.add_subcommand("arm", "Arms a board, and keeps it so until this program ends");
  add_port_options(*verb, options->port);
  verb->add_option("--seconds", options->seconds, "stop after that time (default: Ctrl-C)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--patience", options->patience_s, "how long to wait for the hand, s")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  add_link_timeout_option(*verb, options->link_timeout_ms);
  verb->add_flag("--clear", options->clear, "clear faults whose cause is gone, first");
  verb->add_flag("--home", options->home, "the device is in its home pose now");
  verb->callback([options, &exit_code] { arm(*options, exit_code); });
}

}  // namespace tactree::cli
