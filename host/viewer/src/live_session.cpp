#include "tactree/viewer/live_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "command_outcome.hpp"
#include "contact_parameters.hpp"
#include "hand_command.hpp"
#include "live_run.hpp"
#include "paper_note.hpp"
#include "steered_hand.hpp"
#include "tactree/core/safety/faults.hpp"
#include "tactree/plant/vectors.hpp"
#include "tactree/simulation/hand_script.hpp"
#include "tactree/simulation/injection.hpp"
#include "tactree/support/explain.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

// Interval of commands and ticks; every fourth turn publishes a frame.
constexpr double kTurn_s = 1.0 / (4.0 * kFrameRate_hz);
constexpr int kTurnsPerFrame = 4;
// A simulation that is further behind real time skips the excess; the frame reports the lost time.
constexpr double kMaxBehind_s = 0.1;
constexpr std::size_t kMaxCommands = 256;

const char* name_of(Modes modes) {
  return modes == Modes::kSurface ? "surface" : modes == Modes::kPaper ? "paper" : "both";
}

const char* name_of(core::RenderMode mode) {
  return mode == core::RenderMode::kPaper ? "paper" : "surface";
}

/// One injection of each kind, with an example value.
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
        "a stiffness of {:.6g} N/m exceeds the stability limit of {:.6g} N/m at "
        "{:.6g} Hz (lower it, or raise damping or rate)",
        c.contact.stiffness_N_m, core::stability_limit(c).with_hand_N_m, c.rate_hz);
  }
  if (start.configuration != core::ConfigurationStatus::kOk) {
    return support::explain(core::refusal_of(c));
  }
  return fmt::format("{}: {}", view.header().name, describe(start));
}

}  // namespace

Modes modes_of(const std::string& name) {
  for (const Modes modes : {Modes::kSurface, Modes::kPaper, Modes::kBoth}) {
    if (name == name_of(modes)) {
      return modes;
    }
  }
  throw SessionRefused(fmt::format("mode: '{}' is unknown (use surface, paper or both)", name));
}

LiveSession::LiveSession(Bodies bodies, std::vector<NamedDevice> devices, const Settings& settings,
                         Placing placing)
    : devices_(std::move(devices)),
      placing_(std::move(placing)),
      first_pose_(bodies.bodies[0].path.first()),
      bodies_(std::move(bodies)),
      settings_(settings) {
  const simulation::HandPath path = simulation::make_script("press", bodies_.views[0], 1.0);
  above_m_ = path.waypoints().front().position_m;
  hand_ = std::make_unique<SteeredHand>(start_of(placed_));
  outcome_ = std::make_unique<CommandOutcome>();
  runs_ = make_runs(settings_, placed_);
  fit_ = check_fit(settings_, placed_);
}

LiveSession::~LiveSession() { stop(); }

const NamedDevice& LiveSession::device(const std::string& name) const {
  const auto found = std::find_if(devices_.begin(), devices_.end(),
                                  [&](const NamedDevice& one) { return one.name == name; });
  if (found == devices_.end()) {
    throw SessionRefused(fmt::format("device: '{}' is unknown", name));
  }
  return *found;
}

simulation::Setup LiveSession::make_setup(const Settings& settings, core::RenderMode mode) const {
  simulation::Setup setup;
  setup.controller = settings.controller;
  setup.controller.mode = mode;
  simulation::use_device(device(settings.device).preset, setup);
  setup.controller.model_origin_m = origin_of(settings);
  setup.controller.supervision.supply_monitored = true;
  core::limit_to_rate(setup.controller);
  if (settings.force_max_N) {
    core::limit_force(setup.controller, *settings.force_max_N);
  }
  return setup;
}

std::vector<simulation::Setup> LiveSession::make_setups(const Settings& settings) const {
  std::vector<simulation::Setup> setups;
  for (const core::RenderMode mode : {core::RenderMode::kSurface, core::RenderMode::kPaper}) {
    if (settings.modes != Modes::kBoth &&
        (settings.modes == Modes::kPaper) != (mode == core::RenderMode::kPaper)) {
      continue;
    }
    setups.push_back(make_setup(settings, mode));
    const core::ConfigurationStatus status = core::check(setups.back().controller);
    if (status != core::ConfigurationStatus::kOk) {  // a simulation requires a valid configuration
      throw SessionRefused(refusal(bodies_.views[0], setups.back(), {.configuration = status}));
    }
  }
  return setups;
}

LiveSession::Runs LiveSession::make_runs(const Settings& settings, const Pose& placed) const {
  Bodies bodies;
  {
    const std::lock_guard lock(mutex_);
    bodies = bodies_;
  }
  if (placed) {
    bodies.bodies[0].path = simulation::BodyPath(*placed);
  }
  Runs runs;
  for (const simulation::Setup& setup : make_setups(settings)) {
    auto run = std::make_unique<LiveRun>(bodies, setup, start_of(placed), 0);
    if (!run->simulation().start_result().ok()) {
      throw SessionRefused(refusal(bodies_.views[0], setup, run->simulation().start_result()));
    }
    run->arm();  // a simulated device needs no confirmation
    runs.push_back(std::move(run));
  }
  return runs;
}

// Commands of a page; may be called from any thread.

Settings LiveSession::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

void LiveSession::report(const std::string& text) { enqueue({{"do", "report"}, {"text", text}}); }

Settings LiveSession::changed(const json& wanted) const {
  Settings settings = settings_;
  for (const auto& [key, value] : wanted.items()) {
    if (set_contact_parameters(settings.controller, key, value)) {
      continue;
    }
    if (key == "force_max_N") {
      settings.force_max_N = number_of(key, value);
    } else if (key == "rate_hz") {
      settings.controller.rate_hz = number_of(key, value);
    } else if (key == "mode" && value.is_string()) {
      settings.modes = modes_of(value.get<std::string>());
    } else if (key == "device" && value.is_string()) {
      settings.device = device(value.get<std::string>()).name;
    } else if (key != "do" && !(key == "restart" && value.is_boolean())) {
      throw no_such_setting(key);
    }
  }
  const float limit_N = device(settings.device).preset.drive.force_max_N;
  if (settings.device != settings_.device) {
    settings.force_max_N.reset();
  }
  if (settings.force_max_N && !(*settings.force_max_N <= limit_N)) {
    throw SessionRefused(
        fmt::format("force_max_N: above {:.6g} N, the limit of {}", limit_N, settings.device));
  }
  return settings;
}

void LiveSession::set(const json& wanted) {
  Settings before;
  Settings settings;
  Pose placed;
  {
    const std::lock_guard lock(mutex_);
    before = settings_;
    settings = changed(wanted);
    placed = placed_;
  }
  (void)make_setups(settings);  // throws
  const bool restarts = wanted.value("restart", false);
  if (!restarts && (settings.controller.rate_hz != before.controller.rate_hz ||
                    settings.device != before.device)) {
    throw SessionRefused(
        "a change of rate or device restarts the simulation without its recorded ticks (add "
        "\"restart\": true)");
  }
  const bool may_refuse_model =
      restarts || settings.modes != before.modes ||
      settings.controller.use_materials != before.controller.use_materials;
  // Slow; not locked, so that the session continues.
  Runs runs = may_refuse_model ? make_runs(settings, placed) : Runs();
  Fit fit = restarts ? check_fit(settings, placed) : Fit();
  const std::lock_guard lock(mutex_);
  settings_ = settings;
  is_changed_ = true;
  if (restarts) {
    next_runs_ = std::move(runs);
    fit_ = std::move(fit);
    is_moved_ = placed_.has_value();  // perhaps meanwhile
  }
}

void LiveSession::enqueue(const json& command) {
  const std::lock_guard lock(mutex_);
  if (command["do"] == "stop") {
    commands_.clear();  // no earlier command may start the device again
  } else if (command["do"] == "hand" && !commands_.empty() && commands_.back()["do"] == "hand") {
    commands_.pop_back();  // only the latest target counts
  }
  if (commands_.size() >= kMaxCommands) {
    throw SessionRefused("too many commands are waiting (send fewer)");
  }
  commands_.push_back(command);
}

std::optional<std::string> LiveSession::command(const json& command) {
  try {
    const std::string name = command.value("do", "");
    if (name == "set") {
      set(command);
      return std::nullopt;
    }
    if (name == "fit" || name == "place") {
      name == "fit" ? fit() : place(command);
      return std::nullopt;
    }
    if (name == "hand") {
      (void)path_of(command);
      (void)speed_of(command);
    } else if (name == "inject") {
      (void)simulation::parse_injection(command.value("fault", "") + "@0");
    } else if (name != "arm" && name != "stop" && name != "clear" && name != "clear_injections") {
      return fmt::format(
          "'{}': unknown command (a simulation has hand, arm, stop, clear, set, inject, "
          "clear_injections, place, fit)",
          name);
    }
    enqueue(command);
    return std::nullopt;
  } catch (const std::exception& error) {  // SessionRefused, or JSON of a wrong type
    return error.what();
  }
}

std::string LiveSession::hello() const {
  json devices = json::array();
  for (const NamedDevice& one : devices_) {
    devices.push_back({{"name", one.name}, {"about", one.about}});
  }
  const std::lock_guard lock(mutex_);
  const Eigen::Vector3d start_m = start_of(placed_);
  const json hello = {{"type", "hello"},
                      {"source", "simulation"},
                      {"models", models_json(bodies_)},
                      {"devices", devices},
                      {"has_materials", has_materials(bodies_)},
                      {"injections", injections_json()},
                      {"hand_start_m", {start_m.x(), start_m.y(), start_m.z()}},
                      {"settings", settings_json()}};
  return hello.dump();
}

json LiveSession::settings_json() const {
  const core::Configuration c = make_setup(settings_, core::RenderMode::kSurface).controller;
  json settings = contact_parameters_json(c);
  settings.update({{"rate_hz", c.rate_hz},
                   {"mode", name_of(settings_.modes)},
                   {"device", settings_.device},
                   {"stiffness_limit_N_m", core::stability_limit(c).with_hand_N_m},
                   {"force_max_N", c.limits.force_max_N},
                   {"force_limit_N", device(settings_.device).preset.drive.force_max_N}});
  return settings;
}

std::string LiveSession::trace_csv() const { return log_.csv(); }

// The session's thread

void LiveSession::run(const Publish& publish) {
  Clock::time_point then = Clock::now();
  for (int count = 0; running(); ++count) {
    const Clock::time_point now = Clock::now();
    const double elapsed_s = std::chrono::duration<double>(now - then).count();
    then = now;
    turn(elapsed_s);
    if (count % kTurnsPerFrame == 0) {
      publish(std::make_shared<const std::string>(frame()));
    }
    std::this_thread::sleep_until(now + std::chrono::duration<double>(kTurn_s));
  }
}

std::string LiveSession::step() {
  for (int i = 0; i < kTurnsPerFrame; ++i) {
    turn(kTurn_s);
  }
  return frame();
}

void LiveSession::turn(double elapsed_s) {
  apply_commands();
  advance(std::min(elapsed_s, kMaxBehind_s));
  lost_s_ += std::max(0.0, elapsed_s - kMaxBehind_s);
}

void LiveSession::apply_commands() {
  std::deque<json> commands;
  Runs next;
  std::optional<Settings> changed;
  Pose moved;
  Eigen::Vector3d start_m;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
    next.swap(next_runs_);
    if (std::exchange(is_changed_, false)) {
      changed = settings_;
    }
    if (std::exchange(is_moved_, false)) {
      moved = placed_;
      bodies_.bodies[0].path = simulation::BodyPath(*placed_);
    }
    start_m = start_of(placed_);
  }
  if (!next.empty()) {
    runs_ = std::move(next);
    hand_ = std::make_unique<SteeredHand>(start_m);
    outcome_ = std::make_unique<CommandOutcome>();
    ticks_due_ = 0.0;
    lost_s_ = 0.0;
    log_.clear();
  }
  if (moved) {
    for (const auto& run : runs_) {
      run->place(*moved);
    }
  }
  if (changed) {
    change_runs(*changed);
  }
  for (const json& command : commands) {
    execute(command);
  }
}

void LiveSession::change_runs(const Settings& settings) {
  LiveRun& now = *runs_[0];
  Runs next;
  bool arms_again = false;
  for (const simulation::Setup& setup : make_setups(settings)) {
    const auto same = std::find_if(runs_.begin(), runs_.end(), [&](const auto& run) {
      return run != nullptr && run->configuration().mode == setup.controller.mode;
    });
    if (same != runs_.end()) {
      arms_again = (*same)->change(setup.controller) || arms_again;
      next.push_back(std::move(*same));
      continue;
    }
    next.push_back(
        std::make_unique<LiveRun>(bodies_, setup, now.tip_m(), now.simulation().next_tick()));
    arms_again = next.back()->continue_from(now) || arms_again;
  }
  if (arms_again) {
    outcome_->armed(now.simulation().time_s());
  }
  runs_ = std::move(next);
}

void LiveSession::execute(const json& command) {
  const std::string name = command["do"];
  const double now_s = runs_[0]->simulation().time_s();
  if (name == "hand") {
    hand_->go(path_of(command), speed_of(command));
  } else if (name == "arm") {
    outcome_->armed(now_s);
    for_each_run(&LiveRun::arm);
  } else if (name == "stop") {
    outcome_->stopped();
    for_each_run(&LiveRun::stop);
  } else if (name == "clear") {
    outcome_->cleared(now_s);
    for_each_run(&LiveRun::clear);
  } else if (name == "clear_injections") {
    outcome_->mended();
    for_each_run(&LiveRun::mend);
  } else if (name == "inject") {
    inject(command["fault"]);
  } else if (name == "report") {
    ++news_number_;
    news_ = command["text"];
  }
}

void LiveSession::for_each_run(void (LiveRun::*act)()) {
  for (const auto& run : runs_) {
    (run.get()->*act)();
  }
}

void LiveSession::inject(const std::string& text) {
  const simulation::InjectedFault fault = simulation::parse_injection(text + "@0");
  outcome_->injected(text, std::string(simulation::shows_when(fault.kind)), runs_[0]->last().status,
                     runs_[0]->simulation().time_s());
  for (const auto& run : runs_) {
    run->inject(fault);
  }
}

void LiveSession::advance(double seconds) {
  const double rate_hz = static_cast<double>(runs_[0]->configuration().rate_hz);
  ticks_due_ += seconds * rate_hz;
  for (; ticks_due_ >= 1.0; ticks_due_ -= 1.0) {
    const plant::HandTarget& hand = hand_->advance(1.0 / rate_hz);
    for (const auto& run : runs_) {
      run->step(hand);
    }
    const simulation::Sample& last = runs_[0]->last();
    log_.add(last);
    if (std::optional<std::string> news = outcome_->update(last.status, last.t_s)) {
      ++news_number_;
      news_ = *std::move(news);
    }
  }
}

std::string LiveSession::frame() {
  json runs = json::array();
  for (const auto& run : runs_) {
    const core::Configuration& c = run->configuration();
    json one = run_json(run->last(), name_of(c.mode), c.device, c.model_origin_m,
                        run->simulation().plant().joints(), bodies_, scratch_);
    one["strip"] = run->strip().take();
    if (c.mode == core::RenderMode::kPaper) {
      one["note"] = paper_note(run->last(), bodies_);
    }
    runs.push_back(std::move(one));
  }
  const Eigen::Vector3d& hand = hand_->position_m();
  json settings;
  json fit;
  json place;
  {
    const std::lock_guard lock(mutex_);
    settings = settings_json();
    fit = {{"warning", named_warning()},
           {"can_scale", fit_.is_oversize && static_cast<bool>(placing_.fit)}};
    if (placing_.renew) {
      place = place_json();
    }
  }
  const double t_s = runs_[0]->last().t_s;
  json frame = {{"type", "frame"},
                {"frame", frames_++},
                {"t_s", t_s},
                {"runs", runs},
                {"hand_m", json::array({hand.x(), hand.y(), hand.z()})},
                {"bodies", poses_json(bodies_, t_s)},
                {"lost_s", lost_s_},
                {"fit", fit},
                {"news", {{"number", news_number_}, {"text", news_}}},
                {"work", unknown_work("Not counted in this simulation (use tactree simulate "
                                      "--board).")},
                {"settings", settings}};
  if (!place.is_null()) {
    frame["place"] = std::move(place);
  }
  return frame.dump();
}

}  // namespace tactree::viewer
