#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "tactree/support/nearest_name.hpp"

namespace tactree::cli {
namespace {

/// Error message for a first argument that is not a command; empty if it is a command or an option.
std::string unknown_verb(const CLI::App& app, const std::string& word) {
  if (word.empty() || word[0] == '-') {
    return "";
  }
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(verb->get_name());
  }
  if (std::find(names.begin(), names.end(), word) != names.end()) {
    return "";
  }
  const std::string nearest = support::nearest_name(word, names);
  return fmt::format("unknown command '{}' ({}tactree --help lists the commands)", word,
                     nearest.empty() ? "" : "did you mean '" + nearest + "'? ");
}

/// The kind of number that an option takes; any kind if the option is unknown.
std::string number_kind(const CLI::App& app, const std::string& option) {
  for (const CLI::App* verb : app.get_subcommands()) {
    const CLI::Option* found = verb->get_option_no_throw(option);
    if (found != nullptr && found->get_type_name().find("INT") != std::string::npos) {
      return "a whole number";
    }
  }
  return "a number";
}

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

/// States which value is no number. CLI11 only says "Could not convert: --turn = x".
std::string not_a_number(const CLI::App& app, const CLI::ConversionError& error) {
  const std::string message = error.what();
  const std::size_t name = message.find(": ");
  const std::size_t value = message.find(" = ");
  if (name == std::string::npos || value == std::string::npos) {
    return message;
  }
  const std::string option = message.substr(name + 2, value - name - 2);
  const std::string text = message.substr(value + 3);
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
  return digits ? fmt::format("{}: {} is too large", option, text)
                : fmt::format("{}: '{}' is not {}", option, text, number_kind(app, option));
}

int run(int argc, char** argv) {
  // If the signal is ignored, a write beyond the limit on file sizes fails with a message and
  // leaves no temporary file.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app{"tactree: builds models from 3D scans and renders them on haptic devices"};
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
  if (const std::string error = unknown_verb(app, argc > 1 ? argv[1] : ""); !error.empty()) {
    fmt::print(stderr, "tactree: error: {}\n", error);
    return kExitUsage;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ConversionError& error) {
    app.exit(CLI::ConversionError(not_a_number(app, error)));
    return kExitUsage;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitUsage;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "tactree: error: out of memory (choose a larger --spacing, or --crop)\n");
    return kExitFailed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "tactree: error: {}\n", error.what());
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
