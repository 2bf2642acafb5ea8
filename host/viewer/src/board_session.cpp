#include "tactree/viewer/board_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "board_facts.hpp"
#include "command_outcome.hpp"
#include "contact_parameters.hpp"
#include "page_recording.hpp"
#include "place_command.hpp"
#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/support/user_error.hpp"
#include "tactree/telemetry/tick_table.hpp"
#include "trace_columns.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxQueued = 64;
constexpr std::chrono::seconds kMaxSilence{2};
// Counts as silence in one pass at most: this program may have stood still, not the board.
constexpr std::chrono::microseconds kMaxCounted{100'000};
constexpr std::chrono::milliseconds kRetryInterval{200};
constexpr std::chrono::milliseconds kMinPause{1};    // between frames, on a slow computer
constexpr std::chrono::seconds kConfirmTimeout{30};  // the default of tactree arm

core::Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

core::Status status_of(const client::Telemetry& t) {
  core::Status s;
  s.tick = t.header.tick;
  s.state = static_cast<core::State>(std::min(t.state, core::kStates - 1U));
  s.faults = t.faults;
  s.limits = t.limits;
  s.overruns = t.overruns;
  s.load = t.load;
  s.probe = vec3(t.probe_m);
  s.velocity = vec3(t.velocity_m_s);
  s.force = vec3(t.force_N);
  s.added_force = vec3(t.added_N);
  s.gravity_force = vec3(t.gravity_N);
  s.motor_force = vec3(t.motors_N);
  core::Rendering& r = s.rendering;
  r.in_contact = t.body != core::kNoBody;
  r.body = t.body;
  r.proxy = vec3(t.proxy_m);
  r.normal = vec3(t.normal);
  r.penetration_m = t.penetration_m;
  r.strength = t.strength;
  r.force = vec3(t.wanted_N);
  return s;
}

}  // namespace

BoardSession::BoardSession(Bodies bodies, BoardSettings settings)
    : bodies_(std::move(bodies)),
      settings_(std::move(settings)),
      board_(std::make_unique<client::Board>(settings_.port, settings_.link)),
      outcome_(std::make_unique<CommandOutcome>()),
      recording_(std::make_unique<PageRecording>(settings_.recording)) {
  begin_session();
}

BoardSession::~BoardSession() { stop(); }

void BoardSession::begin_session() {
  auto facts = std::make_unique<BoardFacts>(ask_board(*board_, settings_.model));
  work_ = work_of(*facts);
  sent_.contact.stiffness_N_m = facts->can.stiffness_N_m;
  facts_ = std::move(facts);
  send_pose();
  subscribe();
  last_pass_ = board_->connection().now();
  silence_ = {};
  last_.reset();
  outcome_->stopped();
  strip_ = {};
  log_.clear();
}

void BoardSession::send_pose() {
  if (!settings_.pose) {
    return;
  }
  const simulation::BodyPath rest(simulation::in_scene(*settings_.pose, facts_->model_origin_m));
  board_->place_body(0, rest.at(0.0).pose);
  bodies_.bodies[0].path = rest;
}

void BoardSession::subscribe() {
  subscription_ = {telemetry::recorded_fields(board_->connection().protocol_minor()),
                   ticks_per_message(*facts_)};
  board_->subscribe(subscription_);
}

Work BoardSession::work_of(const BoardFacts& facts) const {
  if (!settings_.work) {
    return {{}, 0.0, std::nullopt, "The work per tick of this board is unknown."};
  }
  Work work = settings_.work(facts.name, facts.can);
  if (work.bound && facts.model == BoardFacts::Model::kOther) {
    work.bound.reset();
    work.why = "No bound: the board uses a model other than the displayed one.";
  }
  return work;
}

/// Every tick is sent, so that no peak is missed, but at most half of the capacity of a serial line
/// is used.
std::uint32_t BoardSession::ticks_per_message(const BoardFacts& facts) const {
  const std::optional<unsigned> bytes_s = client::wire_speed(settings_.port, settings_.link.baud);
  if (!bytes_s) {
    return 1U;
  }
  const double messages_s =
      std::max(1.0, 0.5 * *bytes_s / static_cast<double>(telemetry::frame_bytes()));
  return static_cast<std::uint32_t>(
      std::max(1.0, std::ceil(static_cast<double>(facts.can.rate_hz) / messages_s)));
}

// Commands of a page; may be called from any thread.

std::string BoardSession::hello() const {
  const json hello = {{"type", "hello"},
                      {"source", "board"},
                      {"models", models_json(bodies_)},
                      {"has_materials", has_materials(bodies_)},
                      {"port", settings_.port}};
  return hello.dump();
}

std::optional<std::string> BoardSession::command(const json& command) {
  try {
    const std::string name = command.value("do", "");
    if (name == "stop") {
      return post_stop();
    }
    if (name == "set") {
      core::Configuration any;
      for (const auto& [key, value] : command.items()) {
        if (key == "force_max_N") {
          (void)number_of(key, value);
        } else if (key != "do" && !set_contact_parameters(any, key, value)) {
          throw no_such_setting(key);
        }
      }
    } else if (name == "place") {
      if (!is_same_scale(placement_of(command).scale, 1.0)) {
        return "place: a board cannot change the size of its model (build the model with --scale, "
               "and write it with tactree flash)";
      }
    } else if (name == "hand" || name == "inject" || name == "clear_injections") {
      return fmt::format(
          "'{}': not available with a board (use a simulation: tactree view without --port)", name);
    } else if (name != "arm" && name != "clear" && name != "connect" && name != "home" &&
               name != "record" && name != "end_recording") {
      return fmt::format(
          "'{}': unknown command (a board has arm, stop, clear, home, set, place, connect, record, "
          "end_recording)",
          name);
    }
    if (name != "connect" && name != "end_recording" && link_ != Link::kConnected) {
      return "the board is not connected";
    }
    enqueue(command);
    return std::nullopt;
  } catch (const std::exception& error) {  // SessionRefused, or JSON of a wrong type
    return error.what();
  }
}

void BoardSession::enqueue(const json& command) {
  const std::lock_guard lock(mutex_);
  if (commands_.size() >= kMaxQueued) {
    throw SessionRefused("too many commands are waiting (send fewer)");
  }
  commands_.push_back(command);
}

// Bypasses the queue. The stop is sent at once, and again by the session's thread until the board
// confirms that it has stopped.
std::optional<std::string> BoardSession::post_stop() {
  {
    const std::lock_guard lock(mutex_);
    // No earlier command may start the board again. A recording goes on or ends as wanted.
    std::erase_if(commands_, [](const json& command) {
      return command["do"] != "record" && command["do"] != "end_recording";
    });
  }
  stop_wanted_ = true;
  const std::unique_lock lock(connecting_, std::try_to_lock);
  if (!lock.owns_lock() || !board_->connected()) {
    return "stop: no connection to the board, which stops after its link timeout (or use the "
           "emergency stop)";
  }
  board_->post_stop();
  return std::nullopt;
}

std::string BoardSession::trace_csv() const {
  return without_columns(log_.csv(), {"tip_x_m", "tip_y_m", "tip_z_m", "slipping"});
}

std::string BoardSession::reach_json() const { return viewer::reach_json(settings_.device); }

// The session's thread

void BoardSession::run(const Publish& publish) {
  constexpr std::chrono::microseconds kPeriod(static_cast<int>(1e6 / kFrameRate_hz));
  while (running()) {
    const Clock::time_point now = Clock::now();
    update_board();
    if (link_ == Link::kLost && now >= next_try_) {
      reconnect();
    }
    publish(std::make_shared<const std::string>(frame()));
    const Clock::duration left = std::max<Clock::duration>(now + kPeriod - Clock::now(), kMinPause);
    if (board_->connected()) {
      board_->connection().sleep(std::chrono::duration_cast<std::chrono::microseconds>(left));
    } else {
      std::this_thread::sleep_for(left);
    }
  }
  recording_->finish();
}

void BoardSession::update_board() {
  std::deque<json> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  try {
    stop_if_wanted();
    for (const json& command : commands) {
      execute(command);
    }
    continue_arming();
  } catch (const client::LinkError& error) {
    report(error.what());
  }
  if (link_ == Link::kConnected) {
    read_telemetry();
  }
  check_link();
  if (const std::optional<std::string> problem = recording_->update()) {
    report(*problem);
  }
}

void BoardSession::stop_if_wanted() {
  if (!board_->connected() || !stop_wanted_.exchange(false)) {
    return;
  }
  arming_until_.reset();
  try {
    board_->stop();
  } catch (const client::LinkError&) {
    stop_wanted_ = true;
    throw;
  }
}

void BoardSession::execute(const json& command) {
  const std::string name = command["do"];
  if (name == "connect") {
    if (link_ != Link::kConnected) {
      reconnect();
    }
  } else if (name == "set") {
    set(command);
  } else if (name == "place") {
    place(command);
  } else if (name == "clear") {
    board_->clear_faults();
    outcome_->cleared(last_ ? last_->t_s : 0.0);
  } else if (name == "home") {
    board_->home();
  } else if (name == "record") {
    begin_recording();
  } else if (name == "end_recording") {
    recording_->end();
  } else if (!arming_until_) {
    board_->begin_arming();
    arming_until_ = board_->connection().now() + kConfirmTimeout;
  }
}

void BoardSession::begin_recording() {
  try {
    recording_->begin({subscription_.fields, subscription_.every_ticks, 0.0});
  } catch (const support::UserError& error) {
    report(error.what());
  }
}

void BoardSession::set(const json& wanted) {
  core::Configuration next = sent_;
  bool material = false;
  bool texture = false;
  for (const auto& [key, value] : wanted.items()) {
    if (set_contact_parameters(next, key, value)) {
      (key.starts_with("texture_") ? texture : material) = true;
    }
  }
  const core::ContactParameters& contact = next.contact;
  if (texture) {
    board_->set_texture({contact.texture_height_m, contact.texture_wavelength_m});
    sent_.contact.texture_height_m = contact.texture_height_m;
    sent_.contact.texture_wavelength_m = contact.texture_wavelength_m;
  }
  if (material) {
    board_->set_material({contact.stiffness_N_m, contact.damping_Ns_m, contact.static_friction,
                          contact.dynamic_friction, next.use_materials ? 1U : 0U});
    sent_ = next;
  }
  if (wanted.contains("force_max_N")) {
    board_->set_limits(number_of("force_max_N", wanted["force_max_N"]), facts_->can.slew_N_s,
                       sent_.limits.ramp_s);
  }
  facts_->can = board_->capabilities();
}

void BoardSession::place(const json& command) {
  const core::State state = last_ ? last_->status.state : core::State::kIdle;
  if (arming_until_ || state == core::State::kArmed || state == core::State::kActive) {
    report(
        "place: the board is armed or active, and a model that jumps would strike the hand (stop "
        "the board first)");
    return;
  }
  settings_.pose = placement_of(command).pose;
  send_pose();
}

void BoardSession::continue_arming() {
  if (!arming_until_) {
    return;
  }
  const bool is_late = board_->connection().now() > *arming_until_;
  try {
    if (board_->go_on_arming()) {
      arming_until_.reset();
    } else if (is_late) {
      arming_until_.reset();
      board_->stop();
      report(fmt::format("arm: not confirmed within 30 s ({})", board_->who_confirms()));
    }
  } catch (const client::LinkError&) {
    arming_until_.reset();
    throw;
  }
}

void BoardSession::read_telemetry() {
  const std::vector<client::Telemetry> messages = board_->take_stream();
  recording_->add(messages);
  for (const client::Telemetry& telemetry : messages) {
    add(telemetry);
  }
}

void BoardSession::add(const client::Telemetry& telemetry) {
  simulation::Sample sample;
  const std::uint32_t since_us = telemetry.header.board_time_us - last_time_us_;
  if (last_) {
    if (since_us == 0U || since_us > 0x80000000U) {
      return;  // out of order
    }
    sample.t_s = last_->t_s + 1e-6 * since_us;
  }
  last_time_us_ = telemetry.header.board_time_us;
  sample.status = status_of(telemetry);
  sample.has_parts = (telemetry.header.fields &
                      static_cast<std::uint32_t>(core::wire::TelemetryField::kParts)) != 0U;
  sample.tip_m = {static_cast<double>(telemetry.probe_m[0]),
                  static_cast<double>(telemetry.probe_m[1]),
                  static_cast<double>(telemetry.probe_m[2])};
  strip_.add(sample.status);
  if (!work_.unit.empty()) {
    strip_.add_work(static_cast<double>(telemetry.load) * work_.per_period);
  }
  log_.add(sample);
  if (const std::optional<std::string> news = outcome_->update(sample.status, sample.t_s)) {
    report(*news);
  }
  last_ = sample;
  silence_ = {};
}

void BoardSession::check_link() {
  if (link_ != Link::kLost && !board_->connected()) {
    set_lost(Link::kLost, "The board is disconnected or without power.");
  }
  if (link_ != Link::kConnected) {
    return;
  }
  const std::chrono::microseconds now = board_->connection().now();
  silence_ += std::min(now - last_pass_, kMaxCounted);
  last_pass_ = now;
  if (!board_->in_session()) {
    set_lost(Link::kTaken, "Another program uses the board, or the board was reset.");
  } else if (silence_ > kMaxSilence) {
    set_lost(Link::kLost, "The board sends no telemetry.");
  }
}

void BoardSession::set_lost(Link link, const std::string& why) {
  read_telemetry();  // what arrived before the loss
  recording_->end(why);
  link_ = link;
  why_lost_ = why;
  arming_until_.reset();
  next_try_ = Clock::now() + kRetryInterval;
}

void BoardSession::reconnect() {
  try {
    {
      const std::lock_guard lock(connecting_);
      board_->reconnect();
    }
    begin_session();
    stop_wanted_ = false;  // a new session starts in the stopped state
    link_ = Link::kConnected;
  } catch (const client::LinkError& error) {
    if (link_ == Link::kLost) {
      why_lost_ = fmt::format("The board is not reachable: {}.", error.what());
    } else {
      report(error.what());
    }
  }
  next_try_ = Clock::now() + kRetryInterval;
}

void BoardSession::report(const std::string& news) {
  ++news_number_;
  news_ = news;
}

std::string BoardSession::frame() {
  const bool has_run = link_ == Link::kConnected && last_;
  json frame = {{"type", "frame"},
                {"frame", frames_++},
                {"t_s", last_ ? last_->t_s : 0.0},
                {"runs", has_run ? json::array({run_of_last_tick()}) : json::array()},
                {"bodies", poses_json(bodies_, 0.0)},
                {"work", work_json(work_)},
                {"settings", settings_json()},
                {"board", board_json()},
                {"recording", recording_->to_json()},
                {"news", {{"number", news_number_}, {"text", news_}}}};
  if (!has_flag(facts_->can, core::wire::BoardFlag::kWatchOnly)) {
    frame["place"] = place_json();
  }
  return frame.dump(-1, ' ', false, json::error_handler_t::replace);
}

json BoardSession::place_json() const {
  const core::Vec3& origin = facts_->model_origin_m;
  const Eigen::Isometry3d pose = bodies_.bodies[0].path.first();
  return {{"pose", simulation::rows_of(simulation::in_device(pose, origin))},
          {"scale", 1.0},
          {"origin_m", {origin.x, origin.y, origin.z}}};
}

json BoardSession::run_of_last_tick() {
  const Bodies none;
  // The points of a different model are not those of the contact.
  const Bodies& known = facts_->model == BoardFacts::Model::kOther ? none : bodies_;
  json run = run_json(*last_, "board", settings_.device, facts_->model_origin_m, std::nullopt,
                      known, scratch_);
  run["slipping"] = nullptr;  // not reported by boards
  run["tip_m"] = nullptr;
  run["strip"] = strip_.take();
  return run;
}

json BoardSession::settings_json() const {
  json settings = contact_parameters_json(sent_);
  const core::wire::CapabilitiesReply& can = facts_->can;
  settings.update({{"stiffness_N_m", can.stiffness_N_m},
                   {"stiffness_limit_N_m", can.stiffness_limit_N_m},
                   {"rate_hz", can.rate_hz},
                   {"force_max_N", can.force_max_N},
                   {"force_limit_N", can.force_limit_N}});
  return settings;
}

json BoardSession::board_json() const {
  const Link link = link_;
  const BoardFacts::Model model = facts_->model;
  return {{"name", facts_->name},
          {"firmware", facts_->firmware},
          {"link", link == Link::kConnected ? "here"
                   : link == Link::kLost    ? "gone"
                                            : "taken"},
          {"why", link == Link::kConnected ? "" : why_lost_},
          {"watch_only", has_flag(facts_->can, core::wire::BoardFlag::kWatchOnly)},
          {"shared", has_flag(facts_->can, core::wire::BoardFlag::kShared)},
          {"model", model == BoardFacts::Model::kSame    ? "same"
                    : model == BoardFacts::Model::kOther ? "other"
                                                         : "unknown"},
          {"about_model", facts_->about_model},
          {"confirm", arming_until_ ? board_->who_confirms() : ""},
          {"load", last_ ? last_->status.load : 0.0F},
          {"dropped", board_->dropped()}};
}

}  // namespace tactree::viewer
