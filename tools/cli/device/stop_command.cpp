#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "tactree/client/connection.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {
namespace {

// Needs no session, because another program may have one. Repeats until the board reports that it
// has stopped.
void stop(const BoardPort& options) {
  constexpr int kTries = 5;
  client::Connection connection(client::open_port(chosen_port(options), options.baud));
  const core::wire::ControlRequest request{
      static_cast<std::uint8_t>(core::wire::ControlCode::kStop), {}, 0};
  for (int i = 0; i < kTries; ++i) {
    if (connection.call(core::wire::MessageKind::kControl, request).ok()) {
      fmt::print("stopped\n");
      return;
    }
  }
  throw support::UserError(connection.name() + ": no answer (use the emergency stop)");
}

}  // namespace

void add_stop_command(CLI::App& app, int&) {
  auto options = std::make_shared<BoardPort>();
  CLI::App* verb = app.add_subcommand("stop", "Stops a board, whichever program armed it");
  add_port_options(*verb, *options);
  verb->callback([options] { stop(*options); });
}

}  // namespace tactree::cli
