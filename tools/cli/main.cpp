#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "usage_errors.hpp"

namespace tactree::cli {
namespace {

/// CLI11 takes -1 for the largest number of an unsigned option.
void refuse_negative_counts(CLI::App& app) {
  for (CLI::App* const verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    for (CLI::Option* const option : verb->get_options()) {
      if (option->get_type_name() == "UINT") {
        option->check([](const std::string& text) {
          return text.starts_with('-')
                     ? fmt::format("'{}' is not a whole number from 0 upwards", text)
                     : "";
        });
      }
    }
    refuse_negative_counts(*verb);
  }
}

/// A device file may have several mistakes, one a line.
void print_errors(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    fmt::print(stderr, "tactree: error: {}\n", text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

int run(int argc, char** argv) {
  // If the signal is ignored, a write beyond the limit on file sizes fails with a message and
  // leaves no temporary file.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app{"tactree: builds models from 3D scans and renders them on haptic devices",
               "tactree"};
  app.set_version_flag("--version", "tactree " TACTREE_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* program, const CLI::Error& error) {
    return usage_error(*program, error);
  });
  int exit_code = kExitOk;
  add_bound_command(app, exit_code);
  add_build_command(app, exit_code);
  add_info_command(app, exit_code);
  add_check_command(app, exit_code);
  add_query_command(app, exit_code);
  add_image_command(app, exit_code);
  add_simulate_command(app, exit_code);
  add_evaluate_command(app, exit_code);
  add_device_command(app, exit_code);
  add_devices_command(app, exit_code);
  add_monitor_command(app, exit_code);
  add_record_command(app, exit_code);
  add_serve_command(app, exit_code);
  add_arm_command(app, exit_code);
  add_stop_command(app, exit_code);
  add_flash_command(app, exit_code);
  add_trace_command(app, exit_code);
  add_params_command(app, exit_code);
  add_keygen_command(app, exit_code);
  add_sign_command(app, exit_code);
  add_view_command(app, exit_code);
  add_completion_command(app, exit_code);
  refuse_negative_counts(app);
  if (const std::string error = unknown_command(app, argc > 1 ? argv[1] : ""); !error.empty()) {
    fmt::print(stderr, "tactree: error: {}\n", error);
    return kExitUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;  // 0: the help
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "tactree: error: out of memory (choose a larger --spacing, or --crop)\n");
    return kExitFailed;
  } catch (const std::exception& error) {
    print_errors(error.what());
    return kExitFailed;
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    fmt::print(stderr,
               "tactree: error: standard output cannot be written (check the disk or the pipe)\n");
    return kExitFailed;
  }
  return exit_code;
}

}  // namespace
}  // namespace tactree::cli

// NOLINTNEXTLINE(bugprone-exception-escape): a failed write of the error message ends the program.
int main(int argc, char** argv) { return tactree::cli::run(argc, argv); }
