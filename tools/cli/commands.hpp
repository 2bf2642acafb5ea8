#pragma once
// The commands of the program `tactree`, each in the source of its name.

#include <CLI/CLI.hpp>

namespace tactree::cli {

// Each function adds its command to `app`; executing the command sets `exit_code`. Errors are
// thrown as std::runtime_error with a text for the user: support::UserError, client::LinkError,
// builder::ReadError, builder::BuildError, wcet::BoundError.

// device/
void add_arm_command(CLI::App& app, int& exit_code);
void add_device_command(CLI::App& app, int& exit_code);
void add_devices_command(CLI::App& app, int& exit_code);
void add_flash_command(CLI::App& app, int& exit_code);
void add_monitor_command(CLI::App& app, int& exit_code);
void add_params_command(CLI::App& app, int& exit_code);
void add_record_command(CLI::App& app, int& exit_code);
void add_serve_command(CLI::App& app, int& exit_code);
void add_stop_command(CLI::App& app, int& exit_code);
void add_trace_command(CLI::App& app, int& exit_code);

// image/
void add_bound_command(CLI::App& app, int& exit_code);
void add_image_command(CLI::App& app, int& exit_code);
void add_keygen_command(CLI::App& app, int& exit_code);
void add_sign_command(CLI::App& app, int& exit_code);

// run/
void add_evaluate_command(CLI::App& app, int& exit_code);
void add_simulate_command(CLI::App& app, int& exit_code);
void add_view_command(CLI::App& app, int& exit_code);

// scan/
void add_build_command(CLI::App& app, int& exit_code);
void add_check_command(CLI::App& app, int& exit_code);
void add_info_command(CLI::App& app, int& exit_code);
void add_query_command(CLI::App& app, int& exit_code);

/// Prints the names of the others and of their options.
void add_completion_command(CLI::App& app, int& exit_code);

}  // namespace tactree::cli
