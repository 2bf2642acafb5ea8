#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "arm_command.hpp"
#include "bound_command.hpp"
#include "build_command.hpp"
#include "check_command.hpp"
#include "command.hpp"
#include "devices_command.hpp"
#include "evaluate_command.hpp"
#include "flash_command.hpp"
#include "image_command.hpp"
#include "info_command.hpp"
#include "keygen_command.hpp"
#include "monitor_command.hpp"
#include "params_command.hpp"
#include "query_command.hpp"
#include "sign_command.hpp"
#include "simulate_command.hpp"
#include "stop_command.hpp"
#include "trace_command.hpp"
#include "view_command.hpp"

int main(int argc, char** argv) {
  using namespace tactree::cli;
  CLI::App app{"tactree: from a scan to a surface that a haptic device can touch"};
  app.set_version_flag("--version", "tactree " TACTREE_VERSION);
  app.require_subcommand(1);
  int exit_code = kExitOk;
  add_bound_command(app, exit_code);
  add_build_command(app, exit_code);
  add_info_command(app, exit_code);
  add_check_command(app, exit_code);
  add_query_command(app, exit_code);
  add_image_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_devices_command(app, exit_code);
  add_monitor_command(app, exit_code);
  add_arm_command(app, exit_code);
  add_stop_command(app, exit_code);
  add_flash_command(app, exit_code);
  add_trace_command(app, exit_code);
  add_params_command(app, exit_code);
  add_keygen_command(app, exit_code);
  add_sign_command(app, exit_code);
  add_view_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "tactree: error: out of memory (choose a larger spacing, or crop)\n");
    return kExitFailed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "tactree: error: {}\n", error.what());
    return kExitFailed;
  }
  if (std::fflush(stdout) != 0) {
    fmt::print(stderr, "tactree: error: standard output cannot be written\n");
    return kExitFailed;
  }
  return exit_code;
}
