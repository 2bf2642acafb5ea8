#include "tactree/share/messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactree/core/contact/renderer.hpp"
#include "tactree/core/control/state_machine.hpp"
#include "tactree/core/safety/faults.hpp"

namespace tactree::share {
namespace {

using nlohmann::json;

// Far above every force: a number that a float holds.
constexpr double kMaxValue = 1e6;
constexpr double kMaxRate_Hz = 1e5;

class NotUnderstood : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

json vector_json(const float (&v)[3]) { return {{"x", v[0]}, {"y", v[1]}, {"z", v[2]}}; }

/// A position of the telemetry, which is in the frame of the model, in that of the device.
json in_device(const float (&v)[3], const core::Vec3& origin_m) {
  return {{"x", v[0] + origin_m.x}, {"y", v[1] + origin_m.y}, {"z", v[2] + origin_m.z}};
}

json fault_names(core::FaultMask mask) {
  json names = json::array();
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    if (core::has_fault(mask, fault)) {
      names.push_back(core::name_of(fault));
    }
  }
  return names;
}

json limit_names(core::LimitMask mask) {
  json names = json::array();
  for (std::uint32_t bit = 0; bit < core::kLimits; ++bit) {
    if ((mask >> bit & 1U) != 0U) {
      names.push_back(core::name_of(static_cast<core::Limit>(1U << bit)));
    }
  }
  return names;
}

json contact_json(const client::Telemetry& tick, const core::Vec3& origin_m) {
  if (tick.body == core::kNoBody) {
    return nullptr;
  }
  return {{"body", tick.body},
          {"depth_m", tick.penetration_m},
          {"normal", vector_json(tick.normal)},
          {"surface_m", in_device(tick.proxy_m, origin_m)}};
}

json board_json(const Description& board) {
  return {{"name", board.name},
          {"firmware", board.firmware},
          {"rate_hz", board.can.rate_hz},
          {"force_max_N", board.can.force_max_N},
          {"client_force_max_N", board.can.host_force_max_N},
          {"watch_only", has_flag(board.can, core::wire::BoardFlag::kWatchOnly)}};
}

json model_json(const Description& board) {
  return {{"name", board.model_name ? json(*board.model_name) : json()},
          {"points", board.model_points ? json(*board.model_points) : json()}};
}

json inverse3_json(const Snapshot& snapshot, bool first) {
  json device = {{"device_id", snapshot.board->device_id},
                 {"state",
                  {{"cursor_position", in_device(snapshot.tick.probe_m, snapshot.board->origin_m)},
                   {"cursor_velocity", vector_json(snapshot.tick.velocity_m_s)}}}};
  if (first) {
    device["config"] = json::object({{"handedness", "right"}});
  }
  return device;
}

json grip_json() {
  return {{"device_id", "neutral"},
          {"state",
           {{"orientation", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}, {"w", 1.0}}},
            {"buttons", {{"a", false}, {"b", false}, {"c", false}}}}}};
}

json tactree_json(const Snapshot& snapshot, const Commander& commander, bool first) {
  const client::Telemetry& tick = snapshot.tick;
  const auto state = static_cast<core::State>(std::min(tick.state, core::kStates - 1U));
  json own = {{"link", snapshot.link == Link::kHere   ? "here"
                       : snapshot.link == Link::kLost ? "lost"
                                                      : "taken"},
              {"why", snapshot.why},
              {"tick", tick.header.tick},
              {"time_us", snapshot.time_us},
              {"state", core::name_of(state)},
              {"faults", fault_names(tick.faults)},
              {"limits", limit_names(tick.limits)},
              {"force_N", vector_json(tick.force_N)},
              {"contact", contact_json(tick, snapshot.board->origin_m)},
              {"overruns", tick.overruns},
              {"load", tick.load},
              {"dropped_ticks", snapshot.dropped},
              {"command", nullptr},
              {"news", {{"number", snapshot.news.number}, {"text", snapshot.news.text}}}};
  if ((tick.header.fields & static_cast<std::uint32_t>(core::wire::TelemetryField::kParts)) != 0U) {
    own["added_N"] = vector_json(tick.added_N);
  }
  if (commander.client != 0U) {
    own["command"] = {{"client", commander.client}, {"address", commander.address}};
  }
  if (first) {
    own["board"] = board_json(*snapshot.board);
    own["model"] = model_json(*snapshot.board);
  }
  return own;
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// Null if there is none.
const json& member(const json& object, const char* name) {
  static const json kNothing;
  const auto found = object.find(name);
  return found == object.end() ? kNothing : *found;
}

double number_at(const json& object, const char* key, const char* where) {
  const json& value = member(object, key);
  if (!value.is_number()) {
    throw NotUnderstood(fmt::format("{}.{}: not a number", where, key));
  }
  return value.get<double>();
}

std::array<float, 3> force_of(const json& command) {
  constexpr const char* kWhere = "set_cursor_force.values";
  const json& values = member(command, "values");
  if (!values.is_object()) {
    throw NotUnderstood(fmt::format("{}: not an object with the numbers x, y and z", kWhere));
  }
  std::array<float, 3> force_N{};
  std::size_t axis = 0;
  for (const char* const name : {"x", "y", "z"}) {
    const double value = number_at(values, name, kWhere);
    if (std::abs(value) > kMaxValue) {
      throw NotUnderstood(fmt::format("{}.{}: {} is too large", kWhere, name, value));
    }
    force_N[axis++] = static_cast<float>(value);
  }
  return force_N;
}

void read_device(const json& device, const std::string& device_id, ClientMessage& message) {
  if (!device.is_object()) {
    throw NotUnderstood("inverse3: a device must be an object");
  }
  const json& id = member(device, "device_id");
  if (id != json(device_id)) {
    throw NotUnderstood(
        fmt::format("inverse3: no device {} (the device_id is \"{}\")", id.dump(), device_id));
  }
  const json& commands = member(device, "commands");
  if (commands.contains("set_cursor_position")) {
    throw NotUnderstood(
        "set_cursor_position: a board renders forces, not positions (use set_cursor_force)");
  }
  if (commands.contains("set_cursor_force")) {
    message.force_N = force_of(commands["set_cursor_force"]);
  }
}

void read_devices(const json& devices, const std::string& device_id, ClientMessage& message) {
  if (!devices.is_array()) {
    throw NotUnderstood("inverse3: must be an array");
  }
  for (const json& device : devices) {
    read_device(device, device_id, message);
  }
}

SubscriptionRequest subscription_of(const json& value) {
  if (!value.is_object()) {
    throw NotUnderstood("subscribe: must be an object such as {\"rate_hz\": 60}");
  }
  SubscriptionRequest wanted;
  wanted.rate_hz = number_at(value, "rate_hz", "subscribe");
  if (wanted.rate_hz < 0.0 || wanted.rate_hz > kMaxRate_Hz) {
    throw NotUnderstood(fmt::format(
        "subscribe.rate_hz: must be in 0 .. {:.0f} (0 ends the subscription)", kMaxRate_Hz));
  }
  if (value.contains("queue")) {
    const json& queue = value["queue"];
    wanted.queue = queue.is_number_unsigned() ? queue.get<std::size_t>() : 0U;
    if (wanted.queue < 1U || wanted.queue > kMaxQueue) {
      throw NotUnderstood(
          fmt::format("subscribe.queue: must be a whole number of 1 .. {}", kMaxQueue));
    }
  }
  return wanted;
}

/// A request is wanted with the value true.
bool wants(const json& own, const char* name) {
  if (!own.contains(name)) {
    return false;
  }
  const json& value = own[name];
  if (!value.is_boolean()) {
    throw NotUnderstood(fmt::format("{}: must be true", name));
  }
  return value.get<bool>();
}

void check_names(const json& own) {
  constexpr std::array kNames = {"stop",    "arm",       "home",         "clear",
                                 "connect", "subscribe", "take_command", "release_command"};
  for (const auto& [name, value] : own.items()) {
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
      throw NotUnderstood(
          fmt::format("'{}': unknown request (there are {})", name, fmt::join(kNames, ", ")));
    }
  }
}

void read_requests(const json& own, ClientMessage& message) {
  if (!own.is_object()) {
    throw NotUnderstood("tactree: must be an object such as {\"stop\": true}");
  }
  message.stop = own.contains("stop");  // whatever its value
  check_names(own);
  if (const auto subscribe = own.find("subscribe"); subscribe != own.end()) {
    message.subscription = subscription_of(*subscribe);
  }
  message.take_command = wants(own, "take_command");
  message.release_command = wants(own, "release_command");
  if (wants(own, "connect")) {
    message.requests.push_back(BoardRequest::kConnect);
  }
  if (wants(own, "clear")) {
    message.requests.push_back(BoardRequest::kClear);
  }
  if (wants(own, "home")) {
    message.requests.push_back(BoardRequest::kHome);
  }
  if (wants(own, "arm")) {
    message.requests.push_back(BoardRequest::kArm);
  }
}

}  // namespace

std::string state_text(const Snapshot& snapshot, Grip grip, const Commander& commander,
                       bool first) {
  json devices = json::array();
  json grips = json::array();
  if (snapshot.link == Link::kHere) {
    devices.push_back(inverse3_json(snapshot, first));
    if (grip == Grip::kNeutral) {
      grips.push_back(grip_json());
    }
  }
  // In this order: with_facts() extends the last object.
  return fmt::format(R"({{"inverse3":{},"wireless_verse_grip":{},"tactree":{}}})", text_of(devices),
                     text_of(grips), text_of(tactree_json(snapshot, commander, first)));
}

std::string with_facts(const std::string& state, const ClientFacts& facts,
                       const std::string& refusal) {
  json client = {{"number", facts.number},
                 {"in_command", facts.in_command},
                 {"dropped", facts.dropped},
                 {"every_ticks", facts.every_ticks}};
  if (!refusal.empty()) {
    client["refused"] = refusal;
  }
  constexpr std::size_t kEnd = 2;  // "}}"
  return fmt::format(R"({},"client":{}}}}})", state.substr(0, state.size() - kEnd),
                     text_of(client));
}

std::string refusal_text(const std::string& refusal) {
  return text_of({{"inverse3", json::array()},
                  {"wireless_verse_grip", json::array()},
                  {"tactree", {{"client", {{"number", 0}, {"refused", refusal}}}}}});
}

ClientMessage read_message(const std::string& text, const std::string& device_id) {
  ClientMessage message;
  const json all = json::parse(text, nullptr, false);
  if (!all.is_object()) {
    message.refusal = "a message must be a JSON object";
    return message;
  }
  try {
    if (const auto own = all.find("tactree"); own != all.end()) {
      read_requests(*own, message);
    }
    if (const auto devices = all.find("inverse3"); devices != all.end()) {
      read_devices(*devices, device_id, message);
    }
  } catch (const NotUnderstood& error) {
    message.refusal = error.what();
  }
  return message;
}

}  // namespace tactree::share
