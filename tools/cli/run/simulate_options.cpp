#include "run/simulate_options.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "option_checks.hpp"
#include "run/wall_options.hpp"
#include "tactree/emulation/board_description.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/user.hpp"
#include "tactree/support/device_file.hpp"

namespace tactree::cli {
namespace {

std::vector<std::string> board_names() {
  std::vector<std::string> names{"host"};
  for (const emulation::BoardDescription& board : emulation::boards()) {
    if (board.is_emulated()) {
      names.emplace_back(board.name);
    }
  }
  return names;
}

void add_controller_options(CLI::App& verb, SimulateOptions& options) {
  core::Configuration& c = options.setup.controller;
  add_wall_options(verb, c);
  verb.add_option("--passivity", c.passivity_Ns_m,
                  "maximum damping of the passivity controller, Ns/m; 0: off")
      ->check(within(0.0, 100.0))
      ->capture_default_str();
  verb.add_option("--static-friction", c.contact.static_friction, "coefficient")
      ->check(within(0.0, 2.0))
      ->capture_default_str();
  verb.add_option("--dynamic-friction", c.contact.dynamic_friction,
                  "coefficient, at most the static one")
      ->check(within(0.0, 2.0))
      ->capture_default_str();
  verb.add_option(
          "--texture-height", c.contact.texture_height_m,
          "amplitude of bumps in the surface, m: at most half of their wavelength; they are up "
          "to twice as deep; 0: smooth")
      ->check(within(0.0, 0.01))
      ->capture_default_str();
  verb.add_option("--texture-wavelength", c.contact.texture_wavelength_m,
                  "distance between the bumps, m")
      ->check(within(1e-4, 1.0))
      ->capture_default_str();
  verb.add_flag("!--no-materials", c.use_materials,
                "ignore the materials of the blob: use the options above everywhere");
  verb.add_option("--force-max", options.force_max_N, "maximum force, N (default: the device's)")
      ->check(within(0.01, 1000.0));
  verb.add_flag("--first-force", options.first_force,
                fmt::format("limits for the first force of a new device: at most {} N at the probe "
                            "even with a wrong sign of a motor, reduced slew rates and efforts, "
                            "and no gravity compensation",
                            core::kFirstForce_N));
}

std::string injection_help() {
  std::string text =
      "inject a fault: PART:KIND[=VALUE]@FROM[..TO], seconds after arming (--panel: after "
      "power-up); repeatable";
  for (const simulation::InjectionHelp& kind : simulation::injection_kinds()) {
    text += fmt::format("\n  {:<22} {}", kind.name, kind.about);
  }
  return text;
}

/// Accepts the texts that `parse` does not refuse.
template <class Parse>
CLI::Validator parsed_by(Parse parse, const char* what) {
  return {[parse](const std::string& text) -> std::string {
            try {
              (void)parse(text);
              return {};
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
          },
          what};
}

void add_injection_option(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--inject", options.injections, injection_help())
      ->check(parsed_by(simulation::parse_injection, "FAULT"))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_panel_options(CLI::App& verb, SimulateOptions& options) {
  CLI::Option* panel = verb.add_flag(
      "--panel", options.panel,
      "the board stands alone and is operated by its button (--press). At time 0 it powers up and "
      "is not homed. A program (--serve) may only watch and stop it. --trace includes button and "
      "lamp");
  // The model and the parameters can also be written over USB, outside of the session that refuses
  // commands.
  panel->excludes(verb.get_option("--usb"))->excludes(verb.get_option("--usb-gadget"));
  verb.add_option(
          "--press", options.presses,
          "press the button, which homes and arms the board after 1 s, stops it at once and "
          "clears a fault after 1 s: FROM..TO, seconds after power-up; repeatable")
      ->check(parsed_by(simulation::parse_press, "PRESS"))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->needs(panel);
}

void add_plant_options(CLI::App& verb, SimulateOptions& options) {
  plant::PlantParameters& plant = options.setup.plant;
  options.cartesian_only = {
      verb.add_option("--device-mass", plant.device.mass_kg, "cartesian: apparent mass, kg")
          ->check(within(1e-4, 100.0))
          ->capture_default_str(),
      verb.add_option("--device-friction", plant.device.coulomb_N,
                      "cartesian: dry friction of each axis, N")
          ->check(within(0.0, 100.0))
          ->capture_default_str(),
      verb.add_option("--encoder-step", options.encoder_step_m, "cartesian: travel of one count, m")
          ->check(within(1e-8, 1e-2))
          ->capture_default_str()};
  verb.add_option("--latency-ticks", options.latency_ticks, "age of an encoder reading, ticks")
      ->check(within(0, core::kMaxDelayTicks))
      ->capture_default_str();
  options.stiffness_given =
      verb.add_option("--hand-stiffness", plant.hand.stiffness_N_m, "spring of the hand, N/m")
          ->check(within(0.0, 1e5))
          ->capture_default_str();
  options.damping_given =
      verb.add_option("--hand-damping", plant.hand.damping_Ns_m, "damper of the hand, Ns/m")
          ->check(within(0.0, 1e3))
          ->capture_default_str();
  verb.add_option("--hand-mass", plant.hand.mass_kg, "mass that moves with the device, kg")
      ->check(within(0.0, 100.0))
      ->capture_default_str();
}

void add_device_options(CLI::App& verb, SimulateOptions& options) {
  std::string names;
  for (const std::string& name : support::device_names()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  verb.add_option("--device", options.device, names + ", or a JSON file that describes another")
      ->capture_default_str();
  verb.add_flag("--dump-device", options.dump_device,
                "print the device as a JSON file that can serve as a template, and exit");
  CLI::Option* origin =
      verb.add_option(
              "--origin", options.origin_m,
              "position of the model's origin in the device's frame (x to the user, y right, z "
              "up), m; default: the model's centre is at the device's origin; with a device of "
              "one or two axes, the centre of the model's top")
          ->expected(3)
          ->check(within(-10.0, 10.0));
  verb.add_option("--pose", options.pose,
                  "pose file, as the page of view saves it: where the model is in the device's "
                  "frame, and its size")
      ->check(existing_file())
      ->excludes(origin)
      ->excludes(verb.get_option("--scene"));
}

void add_output_options(CLI::App& verb, SimulateOptions& options) {
  CLI::Option* record =
      verb.add_option("--record", options.record,
                      "record all inputs of the controller in this file, from its "
                      "configuration on: for --replay");
  CLI::Option* replay =
      verb.add_option(
              "--replay", options.replay,
              "replay this recording, with its blobs as BLOB, on a new controller and compare "
              "each tick bit for bit; if they differ, print the first such tick and exit with "
              "code 1. Device, hand and controller options have no effect")
          ->check(existing_file())
          ->excludes(record)
          ->excludes(verb.get_option("--inject"));
  verb.add_option("--trace", options.trace, "write every tick to this CSV file")
      ->check(written_as(".csv"))
      ->excludes(replay);
  CLI::Option* plot =
      verb.add_option("--plot", options.plot, "draw force and penetration into this SVG file")
          ->check(written_as(".svg"))
          ->excludes(replay);
  verb.add_flag("--compare", options.compare,
                "draw the force of both modes into the plot, along the same path")
      ->needs(plot);
  verb.add_option("--json", options.json, "write the summary to this file");
}

void add_session_options(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("BLOB", options.blobs, "the blob to touch, or several");
  verb.add_option("--scene", options.scene, "JSON file with the blob, pose and motion of each body")
      ->check(existing_file());
  verb.add_option("--board", options.board, "where the controller runs")
      ->check(one_of(board_names()))
      ->capture_default_str();
  verb.add_option("--firmware", options.firmware,
                  "folder with the images of the emulated boards (default: $TACTREE_FIRMWARE, the "
                  "installation, or the build tree)");
  verb.add_option("--mode", options.mode, "method that renders contact")
      ->check(one_of({"surface", "paper"}))
      ->capture_default_str();
  options.seconds_given = verb.add_option("--seconds", options.seconds, "length of the run, s")
                              ->check(is_positive)
                              ->capture_default_str();
}

void add_serve_options(CLI::App& verb, SimulateOptions& options) {
  CLI::Option* serve = verb.add_flag("--serve", options.serve,
                                     "run in real time and accept connections at a port that is "
                                     "printed; without --seconds, until interrupted");
  verb.add_option(
          "--require-key", options.key,
          "with --serve: public key (tactree keygen) that must verify the signature of a model")
      ->needs(serve)
      ->check(existing_file());
  CLI::Option* lock_step =
      verb.add_flag("--lock-step", options.lock_step,
                    "with --serve: use a port step:PATH; time passes only while a program is "
                    "connected and runs, so that the program may be slow or stopped in a debugger");
  lock_step->needs(serve);
  CLI::Option* usb =
      verb.add_flag("--usb", options.on_usb,
                    "with --serve: act as a USB device of this computer (needs root and the module "
                    "vhci-hcd); SIGUSR1 disconnects and reconnects the cable");
  usb->needs(serve)->excludes(lock_step);
  verb.add_option("--usb-gadget", options.usb_port,
                  "with --serve: act as a USB device at this computer's device port, one of "
                  "/sys/class/udc (default: the only one); needs root and the module usb_f_fs")
      ->expected(0, 1)
      ->default_str("")
      ->needs(serve)
      ->excludes(usb)
      ->excludes(lock_step);
  verb.add_flag("--unhomed", options.unhomed,
                "with --serve: start as after power-up, with unknown joint positions; the user "
                "holds the device in its home pose until a program homes it (tactree arm --home)")
      ->needs(serve);
  verb.add_option("--serial", options.serial, "with --serve: last part of the serial number")
      ->needs(serve);
}

void add_hand_options(CLI::App& verb, SimulateOptions& options) {
  CLI::Option* script = verb.add_option("--script", options.script, "motion of the hand")
                            ->check(one_of(simulation::script_names()))
                            ->capture_default_str();
  verb.add_option("--path", options.path,
                  "CSV file with the hand's path: t_s,x,y,z (s, m), by the names of the columns. "
                  "Or a recording of a board or a trace (.csv, .npz): the hand repeats its motion, "
                  "as long as it is unless --seconds is given")
      ->excludes(script);
  verb.add_flag("--allow-no-contact", options.allow_no_contact,
                "exit with code 0 even if the probe never touches the model");
}
}  // namespace

bool is_scene(const SimulateOptions& options) {
  return !options.scene.empty() || !options.pose.empty() || options.blobs.size() > 1;
}

void add_simulate_options(CLI::App& verb, SimulateOptions& options) {
  add_session_options(verb, options);
  add_device_options(verb, options);
  add_serve_options(verb, options);
  add_panel_options(verb, options);
  add_hand_options(verb, options);
  add_controller_options(verb, options);
  add_plant_options(verb, options);
  add_injection_option(verb, options);
  add_output_options(verb, options);
  for (CLI::Option* const option : options.cartesian_only) {
    verb.get_option("--dump-device")->excludes(option);
  }
}

}  // namespace tactree::cli
