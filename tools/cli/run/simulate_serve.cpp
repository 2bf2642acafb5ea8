#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <memory>
#include <utility>

#include "device/board_port.hpp"
#include "image/model_signature.hpp"
#include "interruption.hpp"
#include "run/serve_session.hpp"
#include "run/simulate_run.hpp"
#include "run/simulate_setup.hpp"
#include "run/usb_port.hpp"
#include "tactree/client/lock_step.hpp"
#include "tactree/client/serial_port.hpp"
#include "tactree/emulation/emulated_target.hpp"
#include "tactree/hal/linux/function_fs_controller.hpp"
#include "tactree/hal/linux/usbip_controller.hpp"
#include "tactree/serve/served_target.hpp"
#include "tactree/serve/usb_target.hpp"
#include "tactree/simulation/recording.hpp"
#include "tactree/support/output_file.hpp"

namespace tactree::cli {
namespace {

using hal::linux_usb::UsbPort;

serve::ServeOptions serve_options(const SimulateOptions& options) {
  serve::ServeOptions serving;
  serving.serial = options.serial;
  if (!options.key.empty()) {
    serving.key = read_public_key(options.key);
  }
  return serving;
}

std::unique_ptr<simulation::Target> served_target(const SimulateOptions& options,
                                                  const setup::SceneFile& scene,
                                                  client::Transport& terminal) {
  const support::BlobFile& blob = *scene.files[0];
  const serve::ServeOptions serving = serve_options(options);
  const emulation::BoardDescription* const board = emulation::find_board(options.board);
  if (board == nullptr) {
    return std::make_unique<serve::ServedTarget>(terminal, blob.bytes(), serving);
  }
  if (serving.key) {
    refuse(fmt::format("--require-key: the image of {} has no key", board->name),
           "use --board host");
  }
  emulation::EmulationOptions emulation;
  emulation.image = emulation::find_image(*board, options.firmware);
  emulation.count_instructions = false;
  emulation.served = &terminal;
  return std::make_unique<emulation::EmulatedTarget>(*board, blob.bytes(), emulation);
}

void serve_target(const SimulateOptions& options, const setup::SceneFile& scene,
                  std::unique_ptr<simulation::Target> target, ServeSchedule schedule) {
  simulation::Setup setup = make_setup(options, scene);
  simulation::SessionWriter writer;
  setup.board.recorder = options.record.empty() ? nullptr : &writer;
  simulation::Simulation sim(scene.files[0]->bytes(), setup, hand_path(options, scene),
                             std::move(target));
  check_start(scene.names[0], scene.files[0]->view(), setup, sim.start_result(), options);
  sim.inject(simulation::Injector(injections(options)));
  schedule.rate_hz = static_cast<double>(setup.controller.rate_hz);
  schedule.path_s = options.seconds;
  schedule.presses = presses(options);
  schedule.seconds_max = options.seconds_given->count() != 0 ? options.seconds : 0.0;
  serve_session(sim, schedule);
  if (!options.record.empty()) {
    support::write_file(options.record, writer.finish());
  }
}

void serve_on_usb(const SimulateOptions& options, const setup::SceneFile& scene,
                  const core::usb::Identity& identity, UsbPort& port) {
  auto target = std::make_unique<serve::UsbTarget<UsbPort>>(port, identity, scene.files[0]->bytes(),
                                                            serve_options(options));
  auto& served = *target;
  watch_cable_signal();
  port.plug_in();
  tell_cable(true);
  ServeSchedule schedule;
  schedule.wait = [&](auto due, auto) { serve_until(due, served, port); };
  serve_target(options, scene, std::move(target), schedule);
  port.unplug();
}

void serve_at(const SimulateOptions& options, const setup::SceneFile& scene,
              client::Transport& port, const ServeSchedule& schedule) {
  auto target = served_target(options, scene, port);
  const auto announcement = announce_port(
      port.name(),
      fmt::format("simulated board {}, model {} (tactree simulate --serve, process {})",
                  options.board, scene.names[0], ::getpid()));
  fmt::print("serving at {}\n", port.name());
  std::fflush(stdout);
  serve_target(options, scene, std::move(target), schedule);
}

/// Results that are held in memory until the end of a run, which a served board does not have.
void refuse_results(const SimulateOptions& options) {
  const std::pair<const char*, const std::string*> results[] = {
      {"--trace", &options.trace}, {"--plot", &options.plot}, {"--json", &options.json}};
  for (const auto& [name, file] : results) {
    if (!file->empty()) {
      refuse(fmt::format("{}: not written with --serve", name),
             "record the board with tactree record, or the inputs of its controller with --record");
    }
  }
}

}  // namespace

void serve(const SimulateOptions& options, const setup::SceneFile& scene) {
  watch_interruption();  // before a program finds the port: it may stop the board at once
  refuse_results(options);
  if (!options.pose.empty()) {
    refuse("--pose: a board gets the pose of its model from its application",
           "tactree arm --pose, record --arm --pose and view --port --pose send it; build --pose "
           "places the model itself");
  }
  if ((options.on_usb || options.usb_port) && options.board != "host") {
    refuse(fmt::format("--board {}: an emulated board has no USB port", options.board),
           "use --board host, or omit --usb");
  }
  const emulation::BoardDescription* const board = emulation::find_board(options.board);
  if (board != nullptr && !board->serves) {
    refuse(fmt::format("--board {}: its image does not include the link to an application",
                       options.board),
           "choose another board, or omit --serve");
  }
  core::usb::Identity identity;
  identity.name = "Simulated controller";
  identity.serial = {0, 0, options.serial};
  if (options.on_usb) {
    hal::linux_usb::UsbIpController controller;
    serve_on_usb(options, scene, identity, controller);
  } else if (options.usb_port) {
    hal::linux_usb::FunctionFsController controller(identity, *options.usb_port);
    serve_on_usb(options, scene, identity, controller);
  } else if (options.lock_step) {
    client::LockStepServer server;
    ServeSchedule schedule;
    schedule.wait = [&](auto, auto period) { server.pass(period, interrupted); };
    serve_at(options, scene, server, schedule);
  } else {
    client::PseudoTerminal terminal;
    serve_at(options, scene, terminal, {});
  }
}

}  // namespace tactree::cli
