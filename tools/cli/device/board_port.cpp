#include "device/board_port.hpp"

#include <fmt/format.h>

#include "option_checks.hpp"
#include "tactree/client/announcement.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::cli {

void add_port_options(CLI::App& verb, BoardPort& options) {
  verb.add_option("--port", options.port,
                  fmt::format("port of the board: {}; default: the only one found", kPortForms));
  verb.add_option("--baud", options.baud, "speed of a serial port")->capture_default_str();
}

CLI::Option* add_link_timeout_option(CLI::App& verb, int& milliseconds) {
  return verb
      .add_option("--link-timeout", milliseconds,
                  "the board stops if it receives no heartbeat from this program for this time, ms")
      ->check(within(5, 100))
      ->capture_default_str();
}

std::string chosen_port(const BoardPort& options) {
  if (!options.port.empty()) {
    return options.port;
  }
  const std::vector<std::string> ports = client::list_ports();
  if (ports.empty()) {
    const auto simulated = client::announced_ports();
    throw support::UserError(
        simulated.empty() ? "no board found (plug one in, or give its --port)"
                          : fmt::format("no board found except simulated ones (give --port {})",
                                        simulated.front().port));
  }
  if (ports.size() > 1) {
    throw support::UserError(fmt::format("there are {} ports: {} (choose with --port)",
                                         ports.size(), fmt::join(ports, ", ")));
  }
  return ports.front();
}

std::unique_ptr<client::Board> connect(const BoardPort& options) {
  return std::make_unique<client::Board>(chosen_port(options),
                                         client::BoardOptions{options.baud, 0});
}

std::unique_ptr<client::Announcement> announce_port(const std::string& port,
                                                    const std::string& about) {
  try {
    return std::make_unique<client::Announcement>(client::AnnouncedPort{port, about});
  } catch (const client::LinkError& error) {
    fmt::print(stderr, "tactree: warning: tactree devices will not list this port: {}\n",
               error.what());
    return nullptr;
  }
}

}  // namespace tactree::cli
