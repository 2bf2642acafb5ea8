#include "devices_command.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "command.hpp"
#include "output_file.hpp"
#include "tactree/host/usb_devices.hpp"

namespace tactree::cli {
namespace {

struct DevicesOptions {
  bool install_udev = false;
  bool print_udev = false;
  bool watch = false;
  double seconds = 0.0;
  std::string json;
};

void print_device(const host::UsbDeviceInfo& device, const char* what) {
  if (!device.problem.empty()) {
    fmt::print("{}{}\n", what, device.problem);
    return;
  }
  fmt::print("{}{:<8} {:04x}:{:04x}  {}  {} {}\n", what, device.path, device.vendor, device.product,
             device.serial, device.maker, device.name);
}

nlohmann::json to_json(const host::UsbDeviceInfo& device) {
  return {{"transport", "usb"},        {"path", device.path},   {"vendor", device.vendor},
          {"product", device.product}, {"serial", device.serial}, {"maker", device.maker},
          {"name", device.name},       {"problem", device.problem}};
}

void watch(const DevicesOptions& options) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  host::UsbWatch watch;
  while (options.seconds <= 0.0 ||
         Clock::now() - begin < std::chrono::duration<double>(options.seconds)) {
    for (const host::UsbWatch::Change& change : watch.poll()) {
      print_device(change.device, change.arrived ? "+ " : "- ");
    }
    std::fflush(stdout);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void list(const DevicesOptions& options, int& exit_code) {
  const std::vector<host::UsbDeviceInfo> devices = host::list_usb_devices();
  auto json = nlohmann::json::array();
  bool usable = true;
  for (const host::UsbDeviceInfo& device : devices) {
    print_device(device, "");
    json.push_back(to_json(device));
    usable = usable && device.problem.empty();
  }
  if (devices.empty()) {
    fmt::print("no board is plugged in\n");
  }
  if (!options.json.empty()) {
    write_file(options.json, nlohmann::json{{"devices", json}}.dump(2) + "\n");
  }
  exit_code = usable ? kExitOk : kExitFailed;
}

void devices(const DevicesOptions& options, int& exit_code) {
  try {
    if (options.print_udev) {
      fmt::print("{}", host::udev_rule());
    } else if (options.install_udev) {
      fmt::print("wrote {}; plug the board in again, or run: udevadm trigger\n",
                 host::install_udev_rule());
    } else if (options.watch) {
      watch(options);
    } else {
      list(options, exit_code);
    }
  } catch (const std::runtime_error& error) {
    throw CommandError(error.what());
  }
}

}  // namespace

void add_devices_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* verb = app.add_subcommand("devices", "Lists the boards that are plugged in");
  CLI::Option* watch = verb->add_flag("--watch", options->watch, "tell boards that come and go");
  verb->add_option("--seconds", options->seconds, "how long to watch, s (default: until interrupted)")
      ->check(CLI::PositiveNumber)
      ->needs(watch);
  verb->add_flag("--install-udev", options->install_udev,
                 "as root: let everybody at this computer open boards");
  verb->add_flag("--print-udev", options->print_udev, "print the rule that does so");
  verb->add_option("--json", options->json, "write the list to this file");
  verb->callback([options, &exit_code] { devices(*options, exit_code); });
}

}  // namespace tactree::cli
