// tactree-controller: a Linux board as the controller of a haptic device.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "controller_file.hpp"
#include "dry_run.hpp"
#include "exit_codes.hpp"
#include "service.hpp"
#include "usage_errors.hpp"

namespace tactree {
namespace {

/// Switches the enable line off, for use after a crash, when the state of the line is unknown.
int put_off(const controller::ControllerFile& file) {
  const auto line = hal::linux_gpio::GpioLines::outputs({file.board.enable}, "tactree off", false);
  fmt::print("line '{}' is off\n", file.board.enable);
  return kExitOk;
}

int run(int argc, char** argv) {
  CLI::App app{"tactree-controller: runs the control loop of a haptic device on a Linux board",
               "tactree-controller"};
  app.set_version_flag("--version", "tactree-controller " TACTREE_VERSION " (" +
                                        hal::linux_gpio::gpio_library() + ")");
  app.failure_message([](const CLI::App* program, const CLI::Error& error) {
    return usage_error(*program, error);
  });
  std::string file;
  bool dry_run = false;
  bool off = false;
  app.add_option("file", file, "wiring, device and model of the controller (JSON)")->required();
  auto* const dry = app.add_flag("--dry-run", dry_run,
                                 "check whether the controller would run here, without using any "
                                 "line; exit code 1 if it would not");
  app.add_flag("--off", off, "switch the enable line off and exit, for use after a crash")
      ->excludes(dry);
  try {
    app.parse(argc, argv);
    const controller::ControllerFile read = controller::read_controller_file(file);
    if (dry_run) {
      return controller::print_findings(controller::examine(read));
    }
    return off ? put_off(read) : controller::serve(read);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  } catch (const std::exception& error) {
    fmt::print(stderr, "tactree-controller: error: {}\n", error.what());
    return kExitFailed;
  }
}

}  // namespace
}  // namespace tactree

// NOLINTNEXTLINE(bugprone-exception-escape): a failed write of the error message ends the program.
int main(int argc, char** argv) { return tactree::run(argc, argv); }
