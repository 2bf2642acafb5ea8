#include <fmt/core.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "device/board_port.hpp"
#include "device/board_pose.hpp"
#include "device/device_defaults.hpp"
#include "option_checks.hpp"
#include "run/wall_options.hpp"
#include "scan/board_work.hpp"
#include "scan/named_materials.hpp"
#include "scan/report_colours.hpp"
#include "tactree/builder/up_advice.hpp"
#include "tactree/setup/model_size.hpp"
#include "tactree/setup/scene_file.hpp"
#include "tactree/simulation/placement.hpp"
#include "tactree/support/colour_file.hpp"
#include "tactree/support/device_file.hpp"
#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_recorder.hpp"
#include "tactree/viewer/board_session.hpp"
#include "tactree/viewer/live_session.hpp"
#include "tactree/viewer/server.hpp"
#include "tactree/viewer/trace_playback.hpp"

namespace tactree::cli {
namespace {

struct ViewOptions {
  std::vector<std::string> blobs;
  std::string scene;
  std::string pose;
  std::vector<double> origin_m;
  std::string trace;
  std::string material;
  std::string report;
  std::string colours;
  BoardPort board;
  int link_timeout_ms = 50;
  std::string firmware;
  std::string recording = "recording.csv";
  std::string mode = "surface";
  viewer::Settings settings;
  viewer::ServerOptions server{.address = "127.0.0.1", .port = 8023};
};

viewer::Bodies bodies_of(const setup::SceneFile& scene) {
  viewer::Bodies bodies;
  bodies.bodies = scene.bodies;
  for (const support::BlobFile* const file : scene.files) {
    bodies.views.push_back(file->view());
  }
  return bodies;
}

viewer::Bodies noted_bodies_of(const setup::SceneFile& scene) {
  viewer::Bodies bodies = bodies_of(scene);
  for (const core::BlobView& view : bodies.views) {
    bodies.notes.push_back(builder::up_advice(view).value_or(""));
  }
  return bodies;
}

/// The built-in devices, and the chosen one if it is a file.
std::vector<viewer::NamedDevice> devices(const std::string& chosen) {
  std::vector<viewer::NamedDevice> list;
  bool known = false;
  for (const std::string& name : support::device_names()) {
    list.push_back({name, support::load_device(name).about, support::load_device(name).preset});
    known = known || name == chosen;
  }
  if (!known) {
    const support::Device own = support::load_device(chosen);
    note_defaults(chosen, own);
    list.push_back({chosen, own.about, own.preset});
  }
  return list;
}

/// For the session's thread, therefore without exceptions.
void print_line(const std::string& text) {
  (void)std::fputs((text + "\n").c_str(), stdout);
  (void)std::fflush(stdout);
}

/// The page numbers the names of its recordings, and a device or pipe has no such names.
void check_recording(const std::string& file) {
  telemetry::check_tick_file(file);
  if (support::is_written_in_place(file)) {
    support::refuse(file, "a page records to a file", "give the name of a .csv or .npz");
  }
}

std::unique_ptr<viewer::Source> board_source(const ViewOptions& options,
                                             const setup::SceneFile& scene) {
  if (scene.files.size() != 1) {
    throw support::UserError("--port: a board has only one model (give one BLOB)");
  }
  check_recording(options.recording);
  const support::BlobFile& shown = *scene.files[0];
  viewer::BoardSettings settings;
  settings.port = options.board.port;
  settings.link = {options.board.baud, static_cast<std::uint16_t>(options.link_timeout_ms),
                   telemetry::kStreamCapacity};
  settings.device = support::load_device(options.settings.device).preset.model;
  settings.model = shown.bytes();
  settings.recording = {options.recording, print_line};
  if (!options.pose.empty()) {
    settings.pose = read_board_pose(options.pose).pose;
  }
  settings.work = [&shown, firmware = options.firmware](const std::string& board,
                                                        const core::wire::CapabilitiesReply& can) {
    return work_of_board(board, can, shown.view().header(), firmware);
  };
  return std::make_unique<viewer::BoardSession>(noted_bodies_of(scene), std::move(settings));
}

/// The origin of the scene that the user has stated, in the device frame.
std::optional<core::Vec3> stated_origin(const ViewOptions& options, const setup::SceneFile& scene) {
  if (scene.in_device_frame) {
    return core::Vec3{};
  }
  if (options.origin_m.empty()) {
    return std::nullopt;
  }
  return core::Vec3{static_cast<float>(options.origin_m[0]),
                    static_cast<float>(options.origin_m[1]),
                    static_cast<float>(options.origin_m[2])};
}

std::unique_ptr<viewer::Source> make_source(const ViewOptions& options,
                                            const setup::SceneFile& scene) {
  if (!options.board.port.empty()) {
    return board_source(options, scene);
  }
  const core::DeviceModel device = support::load_device(options.settings.device).preset.model;
  const core::Vec3 origin_m =
      stated_origin(options, scene)
          .value_or(simulation::middle_at_origin(scene.files[0]->view().header(),
                                                 scene.bodies[0].path.first(), device.kind));
  return std::make_unique<viewer::TracePlayback>(viewer::read_trace(options.trace),
                                                 noted_bodies_of(scene), device, origin_m);
}

/// Of the points of the first model in its present size; empty if they are not given.
std::vector<viewer::Rgb> point_colours(const ViewOptions& options, const setup::SceneFile& scene) {
  if (options.colours.empty()) {
    return {};
  }
  std::vector<viewer::Rgb> given =
      support::read_colours(options.colours, *scene.given[0], scene.names[0]);
  if (scene.sources[0].empty()) {
    return given;
  }
  std::vector<viewer::Rgb> shown;
  for (const std::uint32_t source : scene.sources[0]) {
    shown.push_back(given[source]);
  }
  return shown;
}

/// Of the first model, for the legend of the page and its rules.
viewer::ScanFacts scan_facts(const ViewOptions& options, const setup::SceneFile& scene) {
  const std::optional<builder::MaterialMap> map =
      named_materials(options.material, scene.names[0], scene.files[0]->view());
  viewer::ScanFacts facts;
  for (std::size_t i = 0; map && i <= map->colours.size(); ++i) {
    facts.labels.push_back({builder::material_name(*map, i)});
    if (i > 0) {
      facts.labels.back().colour = map->colours[i - 1].colour;
    }
  }
  facts.colours = report_colours(options.report);
  facts.point_colours = point_colours(options, scene);
  return facts;
}

bool is_single(const ViewOptions& options, const setup::SceneFile& scene) {
  return options.scene.empty() && scene.files.size() == 1;
}

void warn(const std::string& text) { fmt::print(stderr, "tactree: warning: {}\n", text); }

void warn_of_size(const setup::SceneFile& scene) {
  if (const auto warning = setup::size_warning(scene.names[0], scene.files[0]->view().header())) {
    warn(*warning);
  }
}

/// A simulation, and the change of its model's size on demand of the page.
class Simulated {
 public:
  Simulated(const ViewOptions& options, setup::SceneFile& scene)
      : scene_(scene),
        session_(noted_bodies_of(scene), devices(options.settings.device), options.settings,
                 is_single(options, scene) ? placing()
                 : scene.in_device_frame   ? viewer::Placing{reach_warning(), {}, {}}
                                           : viewer::Placing{}) {
    if (!session_.warning().empty()) {
      warn(scene.names[0] + ": " + session_.warning());
    } else if (is_single(options, scene)) {
      warn_of_size(scene);
    }
  }

  [[nodiscard]] viewer::LiveSession& session() { return session_; }
  /// Call it before run(); `server` is stopped when the model has another size.
  void stops(viewer::Server& server) { server_ = &server; }
  /// After run(): replaces the model of the scene if its size was changed. Returns the new
  /// placement, empty if the user ended the server.
  std::optional<simulation::Placement> renew_scene() {
    const bool was_renewed = is_renewed_;
    if (scaling_.valid()) {
      scaling_.wait();  // its task uses the server
    }
    if (!was_renewed) {
      return std::nullopt;
    }
    scene_.files[0] = scaled_.file.get();
    scene_.sources[0] = std::move(scaled_.sources);
    scene_.bodies[0].blob = scaled_.file->bytes();
    scene_.bodies[0].path = simulation::BodyPath(placement_.pose);
    scene_.in_device_frame = true;
    scene_.scaled.push_back(std::move(scaled_.file));
    return placement_;
  }

 private:
  decltype(viewer::Placing::warning) reach_warning() {
    return [this](const viewer::NamedDevice& device,
                  const std::optional<simulation::Placement>& placement) {
      const core::DeviceModel& model = device.preset.model;
      return placement ? setup::misplaced_warning(shown(), device.name, model, placement->pose)
                       : setup::oversize_warning(shown(), device.name, model);
    };
  }
  viewer::Placing placing() {
    return {
        reach_warning(),
        [this](const simulation::Placement& wanted) { begin([this, wanted] { renew(wanted); }); },
        [this](const viewer::NamedDevice& device, const simulation::Placement& now) {
          begin([this, device, now] { fit(device, now); });
        }};
  }
  /// The model as it is shown.
  [[nodiscard]] const core::BlobView& shown() const { return scene_.files[0]->view(); }
  /// As the user gave it: the size of a model does not depend on the sizes that it had before.
  [[nodiscard]] const support::BlobFile& given() const { return *scene_.blobs[0]; }

  /// One task at a time.
  template <class Task>
  void begin(Task task) {
    using std::chrono_literals::operator""s;
    if (!scaling_.valid() || scaling_.wait_for(0s) == std::future_status::ready) {
      scaling_ = std::async(std::launch::async, std::move(task));
    }
  }

  void fit(const viewer::NamedDevice& device, const simulation::Placement& now) {
    const std::optional<simulation::Placement> fitted =
        setup::fitted_placement(device.preset.model, given().view().header(), now);
    if (fitted) {
      renew(*fitted);
    } else {
      session_.report(
          "The model cannot be scaled: the origin of the device is not inside its workspace");
    }
  }

  void renew(const simulation::Placement& wanted) {
    session_.report("The model is being scaled; the page starts again with it.");
    try {
      scaled_ = setup::scaled_blob(given(), scene_.names[0], wanted.scale);
      placement_ = wanted;
      is_renewed_ = true;
      server_->stop();
    } catch (const std::exception& error) {
      session_.report(fmt::format("The model cannot be scaled: {}", error.what()));
    }
  }

  setup::SceneFile& scene_;
  viewer::LiveSession session_;
  viewer::Server* server_ = nullptr;
  setup::ScaledBlob scaled_;
  simulation::Placement placement_;
  std::atomic<bool> is_renewed_{false};
  std::future<void> scaling_;  // its task uses the members above
};

void announce(const viewer::Server& server) {
  fmt::print("open {} in a browser (Ctrl+C ends it)\n", server.address());
  std::fflush(stdout);
}

/// Serves the simulation. Returns true if it must be served again, with a model of another size.
bool serve_simulation(ViewOptions& options, setup::SceneFile& scene) {
  Simulated simulated(options, scene);
  const viewer::Site site(bodies_of(scene).views, simulated.session(), scan_facts(options, scene));
  viewer::Server server(options.server, site, simulated.session());
  simulated.stops(server);
  announce(server);
  server.run();
  options.server.port = server.port();
  options.settings = simulated.session().settings();
  const std::optional<simulation::Placement> renewed = simulated.renew_scene();
  if (renewed) {
    options.settings.origin_m = core::Vec3{};
    options.settings.scale = renewed->scale;
  }
  return renewed.has_value();
}

void view(ViewOptions& options) {
  if (!viewer::has_page()) {
    throw support::UserError(
        "view: this program was built without its page (scripts/install-deps view, then configure "
        "with -DTACTREE_PAGE=ON and build again)");
  }
  if (options.blobs.empty() && options.scene.empty()) {
    throw CLI::RequiredError("BLOB");
  }
  options.settings.modes = viewer::modes_of(options.mode);
  setup::SceneFile scene = setup::read_scene(options.scene, options.blobs, options.pose);
  options.settings.origin_m = stated_origin(options, scene);
  options.settings.scale = scene.scales[0];
  if (options.board.port.empty() && options.trace.empty()) {
    while (serve_simulation(options, scene)) {
    }
    return;
  }
  if (is_single(options, scene)) {
    warn_of_size(scene);
  }
  const std::unique_ptr<viewer::Source> source = make_source(options, scene);
  const viewer::Site site(bodies_of(scene).views, *source, scan_facts(options, scene));
  viewer::Server server(options.server, site, *source);
  announce(server);
  server.run();
}

void add_server_options(CLI::App& verb, ViewOptions& options) {
  verb.add_option("--page-port", options.server.port, "TCP port of the page; 0: any free port")
      ->capture_default_str();
  verb.add_option(
          "--address", options.server.address,
          "address to listen on; with an address other than loopback, others on the network can "
          "move the simulated hand, arm the board and record it on the disk of this computer")
      ->capture_default_str();
}

/// Options of a board, which exclude those of a simulation.
void add_board_options(CLI::App& verb, ViewOptions& options) {
  CLI::Option* port =
      verb.add_option("--port", options.board.port,
                      fmt::format("show the board at this port: {}", kPortForms))
          ->check([](const std::string& name) {
            const bool is_number = name.find_first_not_of("0123456789") == std::string::npos;
            return is_number
                       ? "this is the port of a board (for the port of the page, use --page-port " +
                             name + ")"
                       : std::string();
          });
  for (const char* other :
       {"--scene", "--trace", "--mode", "--rate", "--stiffness", "--damping", "--origin"}) {
    port->excludes(other);
  }
  verb.add_option("--baud", options.board.baud, "speed of a serial port")
      ->capture_default_str()
      ->needs(port);
  add_link_timeout_option(verb, options.link_timeout_ms)->needs(port);
  verb.add_option("--firmware", options.firmware,
                  "folder with the board's image, for the bound of a tick (default: as simulate)")
      ->needs(port);
  verb.add_option(
          "--recording", options.recording,
          "file that the button Record of the page writes, as tactree record does: FILE.csv, or "
          "FILE.npz for NumPy; if it exists, a number is added to the name")
      ->capture_default_str()
      ->needs(port);
}

void add_place_options(CLI::App& verb, ViewOptions& options) {
  CLI::Option* origin =
      verb.add_option("--origin", options.origin_m,
                      "position of the model's origin in the device's frame: see simulate")
          ->expected(3)
          ->check(within(-10.0, 10.0));
  verb.add_option("--pose", options.pose,
                  "pose file, as the page saves it: where the model is in the device's frame, and "
                  "its size. With --port: sent to the board, which cannot change the size")
      ->check(existing_file())
      ->excludes(origin)
      ->excludes(verb.get_option("--scene"));
}

void add_session_options(CLI::App& verb, ViewOptions& options) {
  verb.add_option("--device", options.settings.device,
                  "name of a device, or a JSON file that describes it: see simulate. With --port: "
                  "the device to draw")
      ->capture_default_str();
  verb.add_option("--mode", options.mode, "surface, paper, or both side by side")
      ->check(one_of({"surface", "paper", "both"}))
      ->capture_default_str();
  add_wall_options(verb, options.settings.controller);
}

}  // namespace

void add_view_command(CLI::App& app, int&) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* verb = app.add_subcommand("view",
                                      "Serves a page for the browser that shows the model and a "
                                      "simulated hand, a trace or a board");
  verb->add_option("BLOB", options->blobs, "one or more blobs");
  verb->add_option("--scene", options->scene,
                   "JSON file with the positions of the bodies: see simulate")
      ->check(existing_file());
  add_place_options(*verb, *options);
  verb->add_option(
      "--trace", options->trace,
      "play back this trace of simulate --trace, or recording of a board (.csv, .npz), "
      "instead of a simulation");
  verb->add_option("--material", options->material,
                   "file of the option --material of the build: names the materials of the first "
                   "model on the page");
  verb->add_option("--report", options->report,
                   "file of the option --report of the build: the page lists the colours of the "
                   "scan, and makes a file of materials from them")
      ->check(existing_file());
  verb->add_option("--colours,--colors", options->colours,
                   "file of the option --colours of the build: the page shows the first model in "
                   "the colours of its scan")
      ->check(existing_file());
  add_session_options(*verb, *options);
  add_board_options(*verb, *options);
  add_server_options(*verb, *options);
  verb->callback([options] { view(*options); });
}

}  // namespace tactree::cli
