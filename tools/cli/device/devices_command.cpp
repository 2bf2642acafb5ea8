#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "exit_codes.hpp"
#include "option_checks.hpp"
#include "tactree/client/announcement.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/client/usb_devices.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {
namespace {

struct DevicesOptions {
  bool install_udev = false;
  bool print_udev = false;
  bool watch = false;
  double seconds = 0.0;
  BoardPort port;
  std::string json;
};

nlohmann::json probe(const std::string& port, unsigned baud) {
  try {
    const client::Introduction found = client::Board::introduce(client::open_port(port, baud));
    const core::wire::IdentifyReply& board = found.board;
    return {{"port", port},
            {"board", text_of(board.board)},
            {"firmware", text_of(board.firmware)},
            {"serial",
             fmt::format("{:08x}{:08x}{:08x}", board.serial[0], board.serial[1], board.serial[2])},
            {"protocol", fmt::format("{}.{}", board.version_major, board.version_minor)},
            {"watch_only", has_flag(found.can, core::wire::BoardFlag::kWatchOnly)},
            {"shared", has_flag(found.can, core::wire::BoardFlag::kShared)},
            {"complaints", client::complaints(found.start)}};
  } catch (const client::LinkError& error) {
    return {{"port", port}, {"error", error.what()}};
  }
}

void print(const nlohmann::json& device) {
  if (device.contains("error")) {
    fmt::print("{}\n", device["error"].get<std::string>());
    return;
  }
  fmt::print("{}: {}, firmware {}, serial {}, protocol {}\n", device["port"].get<std::string>(),
             device["board"].get<std::string>(), device["firmware"].get<std::string>(),
             device["serial"].get<std::string>(), device["protocol"].get<std::string>());
  if (device["watch_only"].get<bool>()) {
    fmt::print("  a program may only watch and stop it: {}\n",
               device["shared"].get<bool>() ? "another program shares it"
                                            : "it is operated by its button");
  }
  for (const auto& complaint : device["complaints"]) {
    fmt::print("  {}\n", complaint.get<std::string>());
  }
}

void list_devices(const DevicesOptions& options, int& exit_code) {
  std::vector<std::string> ports = client::list_ports();
  if (!options.port.port.empty()) {
    ports = {options.port.port};
  }
  nlohmann::json devices = nlohmann::json::array();
  bool found = false;
  for (const std::string& port : ports) {
    devices.push_back(probe(port, options.port.baud));
    found = found || !devices.back().contains("error");
    print(devices.back());
  }
  if (options.port.port.empty()) {
    for (const client::AnnouncedPort& announced : client::announced_ports()) {
      devices.push_back({{"port", announced.port}, {"simulated", announced.about}});
      found = true;
      fmt::print("{}: {}\n", announced.port, announced.about);
    }
  }
  if (devices.empty()) {
    fmt::print("no port found where a board may be connected (plug one in, or give its --port)\n");
  }
  if (!options.json.empty()) {
    support::write_file(options.json, nlohmann::json{{"devices", devices}}.dump(2) + "\n");
  }
  exit_code = found ? kExitOk : kExitFailed;
}

void watch_devices(double seconds) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  client::UsbWatch watch;
  while (seconds <= 0.0 || Clock::now() - begin < std::chrono::duration<double>(seconds)) {
    for (const client::UsbWatch::Change& change : watch.poll()) {
      const client::UsbDeviceInfo& device = change.device;
      fmt::print("{} usb:{} {} {} {} {}\n", change.arrived ? '+' : '-', device.path, device.serial,
                 device.maker, device.name, device.problem);
    }
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void devices(const DevicesOptions& options, int& exit_code) {
  if (options.print_udev) {
    fmt::print("{}", client::udev_rule());
  } else if (options.install_udev) {
    fmt::print("wrote {}; plug the board in again, or run: udevadm trigger\n",
               client::install_udev_rule());
  } else if (options.watch) {
    watch_devices(options.seconds);
  } else {
    list_devices(options, exit_code);
  }
}

}  // namespace

void add_devices_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* verb = app.add_subcommand("devices",
                                      "Lists the connected boards, and those that tactree simulate "
                                      "--serve simulates; exit code 1 if there is none");
  add_port_options(*verb, options->port);
  CLI::Option* watch = verb->add_flag(
      "--watch", options->watch, "report boards on USB as they are connected and disconnected");
  verb->add_option("--seconds", options->seconds, "time to watch, s (default: until Ctrl-C)")
      ->check(is_positive)
      ->needs(watch);
  verb->add_flag("--install-udev", options->install_udev,
                 "as root: install the udev rule that gives all users access to boards on USB");
  verb->add_flag("--print-udev", options->print_udev, "print that udev rule");
  verb->add_option("--json", options->json, "write the list to this file");
  verb->callback([options, &exit_code] { devices(*options, exit_code); });
}

}  // namespace tactree::cli
