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

namespace tactree::cli {
namespace {

/// Minimum number of insertions, deletions, replacements and swaps of adjacent characters that turn
/// one word into the other (optimal string alignment).
std::size_t edits(const std::string& from, const std::string& to) {
  std::vector<std::vector<std::size_t>> fewest(from.size() + 1U,
                                               std::vector<std::size_t>(to.size() + 1U));
  for (std::size_t i = 0; i <= from.size(); ++i) {
    for (std::size_t j = 0; j <= to.size(); ++j) {
      if (i == 0 || j == 0) {
        fewest[i][j] = i + j;
        continue;
      }
      const std::size_t replaced = fewest[i - 1][j - 1] + (from[i - 1] == to[j - 1] ? 0U : 1U);
      fewest[i][j] = std::min({fewest[i - 1][j] + 1U, fewest[i][j - 1] + 1U, replaced});
      if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1]) {
        fewest[i][j] = std::min(fewest[i][j], fewest[i - 2][j - 2] + 1U);
      }
    }
  }
  return fewest.back().back();
}

/// Error message for a first argument that is not a command; empty if it is a command or an option.
std::string unknown_verb(const CLI::App& app, const std::string& word) {
  if (word.empty() || word[0] == '-') {
    return "";
  }
  std::string nearest;
  std::size_t fewest = std::max<std::size_t>(3, word.size() / 2U + 1U);
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string name = verb->get_name();
    if (name == word) {
      return "";
    }
    if (const std::size_t count = edits(word, name); count < fewest) {
      fewest = count;
      nearest = name;
    }
  }
  return fmt::format("unknown command '{}' ({}tactree --help lists the commands)", word,
                     nearest.empty() ? "" : "did you mean '" + nearest + "'? ");
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
  add_devices_command(app, exit_code);
  add_monitor_command(app, exit_code);
  add_record_command(app, exit_code);
  add_arm_command(app, exit_code);
  add_stop_command(app, exit_code);
  add_flash_command(app, exit_code);
  add_trace_command(app, exit_code);
  add_params_command(app, exit_code);
  add_keygen_command(app, exit_code);
  add_sign_command(app, exit_code);
  add_view_command(app, exit_code);
  if (const std::string error = unknown_verb(app, argc > 1 ? argv[1] : ""); !error.empty()) {
    fmt::print(stderr, "tactree: error: {}\n", error);
    return kExitUsage;
  }
  try {
    app.parse(argc, argv);
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
