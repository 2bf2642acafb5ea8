#include "tactree/viewer/board_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "board_facts.hpp"
#include "csv.hpp"
#include "feel.hpp"
#include "tactree/host/link_error.hpp"
#include "tactree/host/ports.hpp"

namespace tactree::viewer {
namespace {

using nlohmann::json;

constexpr std::size_t kMostWaiting = 64;
constexpr std::chrono::seconds kLongestSilence{2};
constexpr std::chrono::milliseconds kBetweenTries{200};
constexpr std::chrono::seconds kPatience{30};  // for the hand, as tactree arm has it

// All but the reactions of bodies.
constexpr std::uint32_t kFields = 0x1FF;
// Of a message with these: header, fields, and what frames it.
constexpr unsigned kMessageBytes = 140;

core::Vec3 vec3(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

core::Status status_of(const host::Telemetry& t) {
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
      board_(std::make_unique<host::Board>(settings_.port, settings_.link)) {
  get_acquainted();
}

BoardSession::~BoardSession() { stop(); }

void BoardSession::get_acquainted() {
  auto facts = std::make_unique<BoardFacts>(ask_board(*board_, settings_.model));
  work_ = work_of(*facts);
  feel_.stiffness_N_m = facts->can.stiffness_N_m;
  board_->subscribe({kFields, ticks_per_message(*facts)});
  facts_ = std::move(facts);
  heard_ = Clock::now();
  last_.reset();
  strip_ = {};
  log_.clear();
}

Work BoardSession::work_of(const BoardFacts& facts) const {
  if (!settings_.work) {
    return {{}, 0.0, std::nullopt, "What a tick of this board has to do is not known."};
  }
  Work work = settings_.work(facts.name, facts.can);
  if (work.bound && facts.model == BoardFacts::Model::kOther) {
    work.bound.reset();
    work.why = "No bound is drawn: the board uses another model than the one shown.";
  }
  return work;
}

/// Every tick, so that the strips miss no peak; but half of a wire is for what else is said.
std::uint32_t BoardSession::ticks_per_message(const BoardFacts& facts) const {
  const std::optional<unsigned> bytes_s = host::wire_speed(settings_.port, settings_.link.baud);
  if (!bytes_s) {
    return 1U;
  }
  const double messages_s = std::max(1.0, 0.5 * *bytes_s / kMessageBytes);
  return static_cast<std::uint32_t>(
      std::max(1.0, std::ceil(static_cast<double>(facts.can.rate_hz) / messages_s)));
}

// What a page says. Any thread.

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
        } else if (key != "do" && !set_feel(any, key, value)) {
          throw no_such_setting(key);
        }
      }
    } else if (name == "hand" || name == "inject" || name == "mend") {
      return fmt::format("'{}': this is a real board, with its own hand and parts", name);
    } else if (name != "arm" && name != "clear" && name != "connect") {
      return fmt::format("'{}' is none of a board's commands", name);
    }
    if (name != "connect" && link_ != Link::kHere) {
      return "the board is not connected";
    }
    enqueue(command);
    return std::nullopt;
  } catch (const std::exception& error) {  // a refusal, or JSON of another kind than asked for
    return error.what();
  }
}

void BoardSession::enqueue(const json& command) {
  const std::lock_guard lock(mutex_);
  if (commands_.size() >= kMostWaiting) {
    throw SessionRefused("too many commands at once");
  }
  commands_.push_back(command);
}

// Not in the queue, behind answers that are waited for: sent now, and again by the session's thread
// until the board says that it has stopped.
std::optional<std::string> BoardSession::post_stop() {
  {
    const std::lock_guard lock(mutex_);
    commands_.clear();  // nothing that was said before may start again
  }
  stop_wanted_ = true;
  const std::unique_lock lock(connecting_, std::try_to_lock);
  if (!lock.owns_lock() || !board_->connected()) {
    return "stop: the board is gone, and ends the force by itself (else use the emergency stop)";
  }
  board_->post_stop();
  return std::nullopt;
}

std::string BoardSession::trace_csv() const {
  return without_columns(log_.csv(), {"tip_x_m", "tip_y_m", "tip_z_m", "slipping"});
}

// The session's thread.

void BoardSession::run(const Publish& publish) {
  const std::chrono::duration<double> period(1.0 / kFrameRate_hz);
  while (running()) {
    const Clock::time_point now = Clock::now();
    use_board();
    if (link_ == Link::kGone && now >= next_try_) {
      connect_again();
    }
    publish(std::make_shared<const std::string>(frame()));
    std::this_thread::sleep_until(now + period);
  }
}

void BoardSession::use_board() {
  std::deque<json> commands;
  {
    const std::lock_guard lock(mutex_);
    commands.swap(commands_);
  }
  try {
    stop_if_wanted();
    for (const json& command : commands) {
      obey(command);
    }
    go_on_arming();
  } catch (const host::LinkError& error) {
    tell(error.what());
  }
  if (link_ == Link::kHere) {
    take_telemetry();
  }
  notice_loss();
}

void BoardSession::stop_if_wanted() {
  if (!board_->connected() || !stop_wanted_.exchange(false)) {
    return;
  }
  arming_until_.reset();
  try {
    board_->stop();
  } catch (const host::LinkError&) {
    stop_wanted_ = true;
    throw;
  }
}

void BoardSession::obey(const json& command) {
  const std::string name = command["do"];
  if (name == "connect") {
    if (link_ != Link::kHere) {
      connect_again();
    }
  } else if (name == "set") {
    set(command);
  } else if (name == "clear") {
    board_->clear_faults();
  } else if (!arming_until_) {
    board_->begin_arming();
    arming_until_ = Clock::now() + kPatience;
  }
}

void BoardSession::set(const json& wanted) {
  core::Configuration feel = feel_;
  bool feels_else = false;
  for (const auto& [key, value] : wanted.items()) {
    feels_else = set_feel(feel, key, value) || feels_else;
  }
  if (feels_else) {
    board_->set_material({feel.stiffness_N_m, feel.damping_Ns_m, feel.static_friction,
                          feel.dynamic_friction, feel.use_materials ? 1U : 0U});
    feel_ = feel;
  }
  if (wanted.contains("force_max_N")) {
    board_->set_limits(number_of("force_max_N", wanted["force_max_N"]), facts_->can.slew_N_s,
                       feel_.ramp_s);
  }
  facts_->can = board_->capabilities();
}

void BoardSession::go_on_arming() {
  if (!arming_until_) {
    return;
  }
  const bool is_late = Clock::now() > *arming_until_;
  try {
    if (board_->go_on_arming()) {
      arming_until_.reset();
    } else if (is_late) {
      arming_until_.reset();
      board_->stop();
      tell(fmt::format("arm: nobody confirms ({})", board_->who_confirms()));
    }
  } catch (const host::LinkError&) {
    arming_until_.reset();
    throw;
  }
}

void BoardSession::take_telemetry() {
  for (const host::Telemetry& telemetry : board_->take_stream()) {
    add(telemetry);
  }
}

void BoardSession::add(const host::Telemetry& telemetry) {
  simulation::Sample sample;
  const std::uint32_t since_us = telemetry.header.board_time_us - last_time_us_;
  if (last_) {
    if (since_us == 0U || since_us > 0x80000000U) {
      return;  // the board's time does not go back
    }
    sample.t_s = last_->t_s + 1e-6 * since_us;
  }
  last_time_us_ = telemetry.header.board_time_us;
  sample.status = status_of(telemetry);
  sample.tip_m = {static_cast<double>(telemetry.probe_m[0]),
                  static_cast<double>(telemetry.probe_m[1]),
                  static_cast<double>(telemetry.probe_m[2])};
  strip_.add(sample.status);
  if (!work_.unit.empty()) {
    strip_.add_work(static_cast<double>(telemetry.load) * work_.per_period);
  }
  log_.add(sample);
  last_ = sample;
  heard_ = Clock::now();
}

void BoardSession::notice_loss() {
  if (link_ != Link::kGone && !board_->connected()) {
    lose(Link::kGone, "The board is gone: unplugged, or without power.");
  }
  if (link_ != Link::kHere) {
    return;
  }
  if (!board_->in_session()) {
    lose(Link::kTaken, "Another program has taken the board, or it was reset.");
  } else if (Clock::now() - heard_ > kLongestSilence) {
    lose(Link::kGone, "The board is silent.");
  }
}

void BoardSession::lose(Link link, const std::string& why) {
  link_ = link;
  why_not_here_ = why;
  arming_until_.reset();
  next_try_ = Clock::now() + kBetweenTries;
}

void BoardSession::connect_again() {
  try {
    {
      const std::lock_guard lock(connecting_);
      board_->reconnect();
    }
    get_acquainted();
    stop_wanted_ = false;  // a new session begins stopped
    link_ = Link::kHere;
  } catch (const host::LinkError& error) {
    if (link_ == Link::kGone) {
      why_not_here_ = fmt::format("The board is gone: {}.", error.what());
    } else {
      tell(error.what());
    }
  }
  next_try_ = Clock::now() + kBetweenTries;
}

void BoardSession::tell(const std::string& news) {
  ++news_number_;
  news_ = news;
}

std::string BoardSession::frame() {
  const bool shows = link_ == Link::kHere && last_;
  const json frame = {{"type", "frame"},
                      {"frame", frames_++},
                      {"t_s", last_ ? last_->t_s : 0.0},
                      {"runs", shows ? json::array({run_of_last_tick()}) : json::array()},
                      {"bodies", poses_json(bodies_, 0.0)},
                      {"work", work_json(work_)},
                      {"settings", settings_json()},
                      {"board", board_json()},
                      {"news", {{"number", news_number_}, {"text", news_}}}};
  return frame.dump(-1, ' ', false, json::error_handler_t::replace);
}

json BoardSession::run_of_last_tick() {
  const Bodies none;
  // Points of another model would only look like those of the contact.
  const Bodies& known = facts_->model == BoardFacts::Model::kOther ? none : bodies_;
  json run = run_json(*last_, "board", settings_.device, facts_->model_origin_m, std::nullopt,
                      known, scratch_);
  run["slipping"] = nullptr;  // a board does not tell
  run["tip_m"] = nullptr;
  run["strip"] = strip_.take();
  return run;
}

json BoardSession::settings_json() const {
  json settings = feel_json(feel_);
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
          {"link", link == Link::kHere   ? "here"
                   : link == Link::kGone ? "gone"
                                         : "taken"},
          {"why", link == Link::kHere ? "" : why_not_here_},
          {"model", model == BoardFacts::Model::kSame    ? "same"
                    : model == BoardFacts::Model::kOther ? "other"
                                                         : "unknown"},
          {"about_model", facts_->about_model},
          {"confirm", arming_until_ ? board_->who_confirms() : ""},
          {"load", last_ ? last_->status.load : 0.0F},
          {"dropped", board_->dropped()}};
}

}  // namespace tactree::viewer
