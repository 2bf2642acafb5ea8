#include "tactree/viewer/live_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "feel.hpp"
#include "tactree/core/faults.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/simulation/placement.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

// Commands are taken and ticks made up so often; every fourth time there is a frame.
constexpr double kTurn_s = 1.0 / (4.0 * kFrameRate_hz);
constexpr int kTurnsPerFrame = 4;
// A machine that is too slow for real time loses what is more than this, and tells so.
constexpr double kMostBehind_s = 0.1;
constexpr std::size_t kMostCommands = 256;

const char* name_of(Modes modes) {
  return modes == Modes::kSurface ? "surface" : modes == Modes::kPaper ? "paper" : "both";
}

const char* name_of(core::RenderMode mode) {
  return mode == core::RenderMode::kPaper ? "paper" : "surface";
}

Eigen::Vector3d place(const json& value) {
  constexpr double kFurthest_m = 10.0;
  if (!value.is_array() || value.size() != 3) {
    throw SessionRefused("target_m: three numbers are needed");
  }
  Eigen::Vector3d target;
  for (std::size_t i = 0; i < 3; ++i) {
    target[static_cast<Eigen::Index>(i)] = static_cast<double>(number_of("target_m", value[i]));
  }
  if (!target.allFinite() || target.cwiseAbs().maxCoeff() > kFurthest_m) {
    throw SessionRefused(fmt::format("target_m: it is outside +-{} m", kFurthest_m));
  }
  return target;
}

/// An injection of each kind, ready to be given.
json injections_json() {
  const std::pair<const char*, const char*> values[] = {{"encoderN:jump", "500"},
                                                        {"motor:weak", "0.1"},
                                                        {"supply:sag", "12"},
                                                        {"loop:overrun", "2"},
                                                        {"clock:drift", "20000"}};
  json list = json::array();
  for (const simulation::InjectionHelp& kind : simulation::injection_kinds()) {
    std::string text(kind.name);
    for (const auto& [name, value] : values) {
      text += kind.name == name ? "=" + std::string(value) : "";
    }
    const std::size_t axis = text.find("N:");
    if (axis != std::string::npos) {
      text[axis] = '1';
    }
    list.push_back({{"fault", text}, {"about", kind.about}});
  }
  return list;
}

std::string refusal(const core::BlobView& view, const simulation::Setup& setup,
                    const hal::StartResult& start) {
  const core::Configuration& c = setup.controller;
  if (start.configuration == core::ConfigurationStatus::kUnstable) {
    return fmt::format(
        "a stiffness of {:.6g} N/m is beyond the stability limit of {:.6g} N/m at "
        "{:.6g} Hz (lower it, or raise damping or rate)",
        c.stiffness_N_m, core::stability_limit(c).with_hand_N_m, c.rate_hz);
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    return core::describe(start.configuration);
  }
  if (start.blob != core::BlobStatus::kOk) {
    return fmt::format("the model is refused: {}", core::describe(start.blob));
  }
  return fmt::format("{}: {}", view.header().name, core::describe(start.model));
}

}  // namespace

Modes modes_of(const std::string& name) {
  for (const Modes modes : {Modes::kSurface, Modes::kPaper, Modes::kBoth}) {
    if (name == name_of(modes)) {
      return modes;
    }
  }
  throw SessionRefused(fmt::format("mode: '{}' is none of surface, paper, both", name));
}

/// A controller, its device, and the person that holds it.
struct LiveSession::Run {
  Run(const Bodies& bodies, const simulation::Setup& its_setup, const Eigen::Vector3d& hand_m)
      : setup(its_setup),
        sim(bodies.bodies[0].blob, its_setup, simulation::HandPath({{0.0, hand_m}}),
            std::make_unique<simulation::SceneTarget>(bodies.bodies, 0)) {}

  void arm() {
    sim.board().safety_inputs().hold_dead_man(false);
    sim.post(core::Command::kArm);
    hold_at_s = sim.time_s() + 0.08;
  }
  void stop() {
    sim.board().safety_inputs().hold_dead_man(false);
    sim.post(core::Command::kStop);
    hold_at_s = -1.0;
  }
  void clear() {
    sim.post(core::Command::kClearFault);
    stop_next = true;
  }

  void step(const plant::HandTarget& hand) {
    if (hold_at_s >= 0.0 && sim.time_s() >= hold_at_s) {
      sim.board().safety_inputs().hold_dead_man(true);
      hold_at_s = -1.0;
    }
    sim.steer(hand);
    last = sim.step();
    strip.add(last.status);
    if (std::exchange(stop_next, false)) {
      stop();  // a fault that was cleared is left by a stop
    }
  }

  simulation::Setup setup;
  simulation::Simulation sim;
  simulation::Sample last{};
  Strip strip;
  double hold_at_s = -1.0;  // when the hand takes hold of the dead-man control; < 0: not to come
  bool stop_next = false;
};

/// Follows what the page says without jumps: pages speak 60 times a second, the hand moves on.
class LiveSession::Hand {
 public:
  explicit Hand(const Eigen::Vector3d& at_m) : goal_(at_m) { now_.position_m = at_m; }

  void go(const Eigen::Vector3d& goal_m) { goal_ = goal_m; }
  void stay() { goal_ = now_.position_m; }
  const plant::HandTarget& advance(double dt) {
    constexpr double kFollow_s = 0.03;
    constexpr double kFastest_m_s = 0.5;
    Eigen::Vector3d velocity = (goal_ - now_.position_m) / kFollow_s;
    const double speed = velocity.norm();
    velocity *= speed > kFastest_m_s ? kFastest_m_s / speed : 1.0;
    now_.position_m += dt * velocity;
    now_.velocity_m_s = velocity;
    return now_;
  }
  [[nodiscard]] const Eigen::Vector3d& position_m() const { return now_.position_m; }

 private:
  Eigen::Vector3d goal_;
  plant::HandTarget now_{};
};

LiveSession::LiveSession(Bodies bodies, std::vector<NamedDevice> devices, const Settings& settings)
    : bodies_(std::move(bodies)), devices_(std::move(devices)), settings_(settings) {
  const simulation::HandPath way = simulation::make_script("press", bodies_.views[0], 1.0);
  start_m_ = bodies_.bodies[0].path.first() * way.waypoints().front().position_m;
  hand_ = std::make_unique<Hand>(start_m_);
  runs_ = make_runs(settings_);
}

LiveSession::~LiveSession() { stop(); }

const NamedDevice& LiveSession::device(const std::string& name) const {
  const auto found = std::find_if(devices_.begin(), devices_.end(),
                                  [&](const NamedDevice& one) { return one.name == name; });
  if (found == devices_.end()) {
    throw SessionRefused(fmt::format("device: there is no '{}'", name));
  }
  return *found;
}

simulation::Setup LiveSession::make_setup(const Settings& settings, core::RenderMode mode) const {
  simulation::Setup setup;
  setup.controller = settings.controller;
  setup.controller.mode = mode;
  simulation::use_device(device(settings.device).figures, setup);
  setup.controller.model_origin_m = simulation::middle_at_origin(
      bodies_.views[0].header(), bodies_.bodies[0].path.first(), setup.controller.device.kind);
  setup.controller.supply_monitored = true;
  setup.controller.velocity_cutoff_hz =
      std::min(setup.controller.velocity_cutoff_hz, 0.5F * setup.controller.rate_hz);
  return setup;
}

LiveSession::Runs LiveSession::make_runs(const Settings& settings) const {
  Runs runs;
  for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
    const bool wanted = settings.modes == Modes::kBoth ||
                        (settings.modes == Modes::kPaper) == (mode == core::RenderMode::kPaper);
    if (!wanted) {
      continue;
    }
    const simulation::Setup setup = make_setup(settings, mode);
    const core::ConfigurationStatus status = core::check(setup.controller);
    if (status != core::ConfigurationStatus::kOk) {  // before a simulation is made of it
      throw SessionRefused(refusal(bodies_.views[0], setup, {.configuration = status}));
    }
    auto run = std::make_unique<Run>(bodies_, setup, start_m_);
    if (!run->sim.start_result().ok()) {
      throw SessionRefused(refusal(bodies_.views[0], setup, run->sim.start_result()));
    }
    run->arm();  // nobody is at a simulated device
    runs.push_back(std::move(run));
  }
  return runs;
}

// What a page says. Any thread.

Settings LiveSession::changed(const json& wanted) const {
  Settings settings = settings_;
  for (const auto& [key, value] : wanted.items()) {
    if (set_feel(settings.controller, key, value)) {
      continue;
    }
    if (key == "rate_hz") {
      settings.controller.rate_hz = number_of(key, value);
    } else if (key == "mode" && value.is_string()) {
      settings.modes = modes_of(value.get<std::string>());
    } else if (key == "device" && value.is_string()) {
      settings.device = device(value.get<std::string>()).name;
    } else if (key != "do") {
      throw no_such_setting(key);
    }
  }
  return settings;
}

void LiveSession::begin_anew(const json& wanted) {
  Settings settings;
  {
    const std::lock_guard lock(mutex_);
    settings = changed(wanted);
  }
  Runs runs = make_runs(settings);  // takes a while: the loop goes on meanwhile
  const std::lock_guard lock(mutex_);
  settings_ = settings;
  next_runs_ = std::move(runs);
}

void LiveSession::enqueue(const json& command) {
  const std::lock_guard lock(mutex_);
  if (command["do"] == "stop") {
    commands_.clear();  // nothing that was said before may start again
  } else if (command["do"] == "hand" && !commands_.empty() && commands_.back()["do"] == "hand") {
    commands_.pop_back();  // only where it is wanted last matters
  }
  if (commands_.size() >= kMostCommands) {
    throw SessionRefused("too many commands at once");
  }
  commands_.push_back(command);
}

std::optional<std::string> LiveSession::command(const json& command) {
  try {
    const std::string name = command.value("do", "");
    if (name == "set") {
      begin_anew(command);
      return std::nullopt;
    }
    if (name == "hand") {
      (void)place(command.value("target_m", json()));
    } else if (name == "inject") {
      (void)simulation::parse_injection(command.value("fault", "") + "@0");
    } else if (name != "arm" && name != "stop" && name != "clear" && name != "mend") {
      return fmt::format("'{}' is none of the simulation's commands", name);
    }
    enqueue(command);
    return std::nullopt;
  } catch (const std::exception& error) {  // a refusal, or JSON of another kind than asked for
    return error.what();
  }
}

std::string LiveSession::hello() const {
  json devices = json::array();
  for (const NamedDevice& one : devices_) {
    devices.push_back({{"name", one.name}, {"about", one.about}});
  }
  const std::lock_guard lock(mutex_);
  const json hello = {{"type", "hello"},
                      {"source", "simulation"},
                      {"models", models_json(bodies_)},
                      {"devices", devices},
                      {"has_materials", has_materials(bodies_)},
                      {"injections", injections_json()},
                      {"settings", settings_json()}};
  return hello.dump();
}

json LiveSession::settings_json() const {
  const core::Configuration c = make_setup(settings_, core::RenderMode::kSurface).controller;
  json settings = feel_json(c);
  settings.update({{"rate_hz", c.rate_hz},
                   {"mode", name_of(settings_.modes)},
                   {"device", settings_.device},
                   {"stiffness_limit_N_m", core::stability_limit(c).with_hand_N_m},
                   {"force_max_N", c.force_max_N}});
  return settings;
}

std::string LiveSession::trace_csv() const { return log_.csv(); }

// The session's thread.

void LiveSession::run(const Publish& publish) {
  Clock::time_point then = Clock::now();
  for (int turn = 0; running(); ++turn) {
    const Clock::time_point now = Clock::now();
    const double elapsed_s = std::chrono::duration<double>(now - then).count();
    then = now;
    take_over();
    advance(std::min(elapsed_s, kMostBehind_s));
    lost_s_ += std::max(0.0, elapsed_s - kMostBehind_s);
    if (turn % kTurnsPerFrame == 0) {
      publish(std::make_shared<const std::string>(frame()));
    }
    std::this_thread::sleep_until(now + std::chrono::duration<double>(kTurn_s));
  }
}

void LiveSession::take_over() {
  std::deque<json> commands;
  Runs next;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
    next.swap(next_runs_);
  }
  if (!next.empty()) {
    runs_ = std::move(next);
    hand_ = std::make_unique<Hand>(start_m_);
    ticks_due_ = 0.0;
    log_.clear();
  }
  for (const json& command : commands) {
    obey(command);
  }
}

void LiveSession::obey(const json& command) {
  const std::string name = command["do"];
  if (name == "hand") {
    hand_->go(place(command["target_m"]));
  }
  for (const auto& run : runs_) {
    if (name == "arm") {
      run->arm();
    } else if (name == "stop") {
      run->stop();
    } else if (name == "clear") {
      run->clear();
    } else if (name == "mend") {
      run->sim.injector().mend(run->sim.time_s());
    } else if (name == "inject") {
      simulation::InjectedFault fault =
          simulation::parse_injection(command["fault"].get<std::string>() + "@0");
      fault.from_s = run->sim.time_s();
      run->sim.injector().add(std::move(fault));
    }
  }
}

void LiveSession::advance(double seconds) {
  const double rate_hz = static_cast<double>(runs_[0]->setup.controller.rate_hz);
  ticks_due_ += seconds * rate_hz;
  for (; ticks_due_ >= 1.0; ticks_due_ -= 1.0) {
    const plant::HandTarget& hand = hand_->advance(1.0 / rate_hz);
    for (const auto& run : runs_) {
      run->step(hand);
    }
    log_.add(runs_[0]->last);
  }
}

std::string LiveSession::frame() {
  json runs = json::array();
  for (const auto& run : runs_) {
    json one = run_json(run->last, name_of(run->setup.controller.mode),
                        run->setup.controller.device, run->setup.controller.model_origin_m,
                        run->sim.plant().joints(), bodies_, scratch_);
    one["strip"] = run->strip.take();
    runs.push_back(std::move(one));
  }
  const Eigen::Vector3d& hand = hand_->position_m();
  json settings;
  {
    const std::lock_guard lock(mutex_);
    settings = settings_json();
  }
  const double t_s = runs_[0]->last.t_s;
  const json frame = {{"type", "frame"},
                      {"frame", frames_++},
                      {"t_s", t_s},
                      {"runs", runs},
                      {"hand_m", json::array({hand.x(), hand.y(), hand.z()})},
                      {"bodies", poses_json(bodies_, t_s)},
                      {"lost_s", lost_s_},
                      {"work", unknown_work("A simulation on this computer counts no instructions: "
                                            "tactree simulate --board does.")},
                      {"settings", settings}};
  return frame.dump();
}

}  // namespace tactree::viewer
