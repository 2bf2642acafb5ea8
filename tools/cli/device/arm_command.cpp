#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "device/board_pose.hpp"
#include "exit_codes.hpp"
#include "interruption.hpp"
#include "option_checks.hpp"
#include "tactree/core/control/controller.hpp"

namespace tactree::cli {
namespace {

struct ArmOptions {
  BoardPort port;
  double patience_s = 30.0;
  double seconds = 0.0;
  int link_timeout_ms = 50;
  std::string pose;
  bool clear = false;
  bool home = false;
};

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

/// Runs until the time is up, Ctrl-C is pressed or the board stops.
void stay(client::Board& board, double seconds, int& exit_code) {
  const client::Connection& connection = board.connection();
  const auto begin = connection.now();
  while (!interrupted() && (seconds <= 0.0 || connection.now() - begin < milliseconds(seconds))) {
    connection.sleep(std::chrono::milliseconds(50));
    const core::wire::StateReply state = board.state();
    if (static_cast<core::State>(state.state) != core::State::kActive) {
      const std::string faults = board.explain(state.faults);
      fmt::print("the board is in state {}{}{}\n",
                 core::name_of(static_cast<core::State>(state.state)), faults.empty() ? "" : ": ",
                 faults);
      exit_code = kExitFailed;
      return;
    }
  }
}

// The session requires its link, so the force ends however this program ends.
void arm(const ArmOptions& options, int& exit_code) {
  watch_interruption();
  client::Board board(chosen_port(options.port),
                      {options.port.baud, static_cast<std::uint16_t>(options.link_timeout_ms)});
  board.require_command("arm");
  if (options.clear) {
    board.clear_faults();
  }
  if (options.home) {
    board.home();
  }
  send_pose(board, options.pose);
  board.arm(milliseconds(options.patience_s));
  fmt::print("active until this program ends\n");
  std::fflush(stdout);
  stay(board, options.seconds, exit_code);
  board.stop();
  fmt::print("stopped\n");
}

}  // namespace

void add_arm_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ArmOptions>();
  CLI::App* verb = app.add_subcommand("arm", "Arms a board until this program ends");
  add_port_options(*verb, options->port);
  verb->add_option("--seconds", options->seconds, "stop after this time, s (default: on Ctrl-C)")
      ->check(is_positive);
  verb->add_option("--patience", options->patience_s,
                   "maximum wait for the dead-man control or the probe, s")
      ->check(within(0.1, 3600.0))
      ->capture_default_str();
  add_link_timeout_option(*verb, options->link_timeout_ms);
  add_pose_option(*verb, options->pose);
  verb->add_flag("--clear", options->clear, "first clear faults whose cause is no longer present");
  verb->add_flag("--home", options->home, "home the device, which must be in its home pose");
  verb->callback([options, &exit_code] { arm(*options, exit_code); });
}

}  // namespace tactree::cli
