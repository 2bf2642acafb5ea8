#pragma once
// Options of `tactree simulate`.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactree/setup/session.hpp"

namespace tactree::cli {

struct SimulateOptions : setup::SessionOptions {
  std::vector<std::string> blobs;
  std::string scene;
  std::string pose;  // pose file of the only model
  std::string blob;  // of the first body
  std::string board = "host";
  std::string firmware;
  bool dump_device = false;
  std::string record;
  std::string replay;
  std::string trace;
  std::string plot;
  bool compare = false;
  std::string json;
  bool serve = false;
  std::string key;  // public key for the models of the served board
  bool lock_step = false;
  bool unhomed = false;
  bool panel = false;                // the board stands alone
  std::vector<std::string> presses;  // of its button
  bool on_usb = false;
  std::optional<std::string> usb_port;  // USB device port of this computer; "": the only one
  std::uint32_t serial = 1;
  std::optional<simulation::HandPath> repeated;  // if --path is a recording or a trace
  CLI::Option* seconds_given = nullptr;
  CLI::Option* stiffness_given = nullptr;  // of the hand
  CLI::Option* damping_given = nullptr;    // of the hand
  std::vector<std::string> injections;
  bool allow_no_contact = false;
  std::vector<CLI::Option*> cartesian_only;
};

/// True for several bodies, or one placed by a scene or pose file.
[[nodiscard]] bool is_scene(const SimulateOptions& options);

/// Adds all options to the command. `options` must outlive it.
void add_simulate_options(CLI::App& verb, SimulateOptions& options);

}  // namespace tactree::cli
