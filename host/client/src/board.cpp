#include "tactree/client/board.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <span>
#include <utility>

#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/core/configuration/parameters.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/math/crc32.hpp"
#include "trace_reader.hpp"

namespace tactree::client {
namespace {

using core::wire::ControlCode;
using core::wire::MessageKind;
using core::wire::WireStatus;

// Pieces of a model that are sent before the first reply: enough to fill the time until it arrives.
constexpr std::size_t kPiecesUnderWay = 6;
constexpr std::size_t kPiecesPerCall = 64;

core::wire::ControlRequest control_request(ControlCode code, std::uint32_t token) {
  return {static_cast<std::uint8_t>(code), {}, token};
}

constexpr char kHowToOperate[] = " (hold its button for 1 s to home, arm or clear a fault)";
constexpr char kShared[] =
    "the board is shared by tactree serve; this program may watch and stop (command the board by "
    "the WebSocket of tactree serve, or end it; its terminal names the program in command)";

const char* remedy_for(WireStatus status) {
  switch (status) {
    case WireStatus::kBusy:
      return " (run tactree stop, then try again)";
    case WireStatus::kNoSession:
      return " (the board was reset, or another program opened a session)";
    case WireStatus::kTooLarge:
      return " (build it with a larger --spacing or with --flash-budget)";
    case WireStatus::kBadSignature:
      return " (sign it with tactree sign and the key that belongs to the board)";
    case WireStatus::kInUse:
      return " (roll back first; if the model in the image fills both slots, program an image with "
             "a smaller one)";
    case WireStatus::kOldCounter:
      return " (sign it with a larger --counter)";
    default:
      return "";
  }
}

std::string why_only_watched(const core::wire::CapabilitiesReply& can) {
  return has_flag(can, core::wire::BoardFlag::kShared)
             ? kShared
             : std::string(core::wire::describe(WireStatus::kWatchOnly)) + kHowToOperate;
}

bool is_too_stiff(const Response& response) {
  core::wire::FinishModelReply reply;
  return response.status == WireStatus::kUnstable ||
         (response.status == WireStatus::kBadModel && response.read(reply) &&
          static_cast<core::ModelStatus>(reply.model) == core::ModelStatus::kTooStiff);
}

/// Returns the cause in the reply for a refused model.
std::string details(const Response& response) {
  core::wire::FinishModelReply reply;
  if (response.status != WireStatus::kBadModel || !response.read(reply)) {
    return "";
  }
  const auto blob = static_cast<core::BlobStatus>(reply.blob);
  return std::string(": ") + (blob != core::BlobStatus::kOk
                                  ? core::describe(blob)
                                  : core::describe(static_cast<core::ModelStatus>(reply.model)));
}

/// "delay_s is 9, outside 0 .. 0.1"
std::string outside(const char* field, float value, float min, float max) {
  char text[160];
  std::snprintf(text, sizeof text, "%s is %g, outside %g .. %g", field, static_cast<double>(value),
                static_cast<double>(min), static_cast<double>(max));
  return text;
}

/// Field, value and range of a setting that the board refuses, which does not state them. `tried`:
/// what it checks. Empty if a value that only the board knows is the cause.
std::string range_of(const core::Configuration& tried) {
  const core::Refusal refusal = core::refusal_of(tried);
  if (refusal.field[0] == '\0' || refusal.status == core::ConfigurationStatus::kUnstable) {
    return "";
  }
  const std::string axis = refusal.axis < 0 ? "" : "[" + std::to_string(refusal.axis) + "]";
  return outside((refusal.field + axis).c_str(), refusal.value, refusal.min, refusal.max);
}

/// As range_of(), with the present values of the board, on which the range may depend.
std::string range_of_parameter(std::span<const core::wire::ParameterReply> present,
                               const core::wire::ParameterReply& parameter, float value,
                               float rate_hz) {
  if (!(value >= parameter.min && value <= parameter.max)) {
    return outside(parameter.name, value, parameter.min, parameter.max);
  }
  core::Configuration tried;
  tried.rate_hz = rate_hz;
  const auto set = [&tried](const core::wire::ParameterReply& p, float to) {
    const bool known = p.number < core::kParameters &&
                       std::strncmp(p.name, core::parameter(p.number).name, sizeof p.name) == 0;
    return known && core::set_parameter(tried, p.number, to);
  };
  if (!std::all_of(present.begin(), present.end(),
                   [&](const auto& p) { return set(p, p.value); }) ||
      !range_of(tried).empty() || !set(parameter, value)) {
    return "";  // of another version, or with limits that the parameters do not include
  }
  return range_of(tried);
}

template <std::size_t N>
void copy(const std::string& from, char (&to)[N]) {
  std::memcpy(to, from.data(), std::min(from.size(), N - 1));
}

std::unique_ptr<Connection> connect(std::unique_ptr<Transport> transport,
                                    const BoardOptions& options) {
  ConnectionOptions connection;
  connection.stream_capacity = options.stream_capacity;
  return std::make_unique<Connection>(std::move(transport), connection);
}

core::wire::MoveBodyRequest move_request(std::uint32_t body, const core::Pose& pose,
                                         const core::Motion& motion, bool enabled) {
  const core::Quaternion& q = pose.rotation;
  const core::Vec3& t = pose.translation_m;
  const core::Vec3& v = motion.linear_m_s;
  const core::Vec3& w = motion.angular_rad_s;
  return {body,
          enabled ? 1U : 0U,
          {q.w, q.v.x, q.v.y, q.v.z},
          {t.x, t.y, t.z},
          {v.x, v.y, v.z},
          {w.x, w.y, w.z}};
}

}  // namespace

std::string names_of(core::FaultMask faults) {
  std::string names;
  for (std::uint32_t code = 1; code < core::kFaultCodes; ++code) {
    const auto fault = static_cast<core::Fault>(code);
    if (core::has_fault(faults, fault)) {
      names += std::string(names.empty() ? "" : ", ") + core::name_of(fault);
    }
  }
  return names;
}

std::string Board::explain(core::FaultMask faults) const {
  const std::string names = names_of(faults);
  if (!core::has_fault(faults, core::Fault::kLinkLost) || options_.link_timeout_ms == 0U) {
    return names;
  }
  return names + " (no heartbeat arrived for " + std::to_string(options_.link_timeout_ms) +
         " ms: the cable is disconnected, or this computer is too busy; end other programs, or "
         "give a longer --link-timeout)";
}

std::string Board::loss() const {
  if (!connection_) {
    return port_ + ": the board is disconnected";
  }
  const std::string name = connection_->name();
  if (!connection_->connected()) {
    return name +
           ": the board is disconnected: it was unplugged, lost its power, or its program "
           "ended (connect it, then reconnect)";
  }
  return connection_->in_session() ? ""
                                   : name +
                                         ": the session has ended: the board was reset, or "
                                         "another program opened a session (reconnect)";
}

Board::Board(const std::string& port, const BoardOptions& options)
    : Board(open_port(port, options.baud), options) {
  port_ = port;
}

Board::Board(std::unique_ptr<Transport> transport, const BoardOptions& options)
    : options_(options), connection_(connect(std::move(transport), options)) {
  connection_->open(options.link_timeout_ms);
}

Board::~Board() {
  if (in_session()) {
    (void)connection_->call(MessageKind::kClose);
  }
}

// The old connection ends first, because a serial port can be opened only once.
void Board::reconnect() {
  if (port_.empty()) {
    throw LinkError(connection().name() +
                    ": cannot be reopened, because it was not opened by name");
  }
  connection_.reset();
  auto fresh = connect(open_port(port_, options_.baud), options_);
  fresh->open(options_.link_timeout_ms);
  connection_ = std::move(fresh);
  if (subscription_) {
    subscribe(*subscription_);
  }
}

Connection& Board::connection() const {
  if (!connection_) {
    throw LinkError(port_ + ": the board is disconnected");
  }
  return *connection_;
}

Introduction Board::introduce(std::unique_ptr<Transport> transport) {
  Connection connection(std::move(transport));
  const Response response = connection.call(MessageKind::kIdentify);
  Introduction introduction;
  if (!response.ok() || !response.read(introduction.board)) {
    throw LinkError(connection.name() +
                    ": no answer (is it a board with Tactree's firmware, and is --baud right?)");
  }
  core::wire::ReadStartReply start;
  const Response started = connection.call(MessageKind::kReadStart);
  if (started.ok() && started.read(start)) {
    introduction.start = start;
  }
  core::wire::CapabilitiesReply can;
  const Response described = connection.call(MessageKind::kCapabilities);
  if (described.ok() && described.read(can)) {
    introduction.can = can;
  }
  return introduction;
}

Response Board::demand(MessageKind kind, std::span<const std::byte> payload, const char* what,
                       const Range& range) {
  Response response = connection().call(kind, payload);
  const std::string where = connection().name() + ": " + what + ": ";
  if (response.timed_out) {
    throw LinkError(where + (connection().connected() ? "no answer" : "the board is disconnected"));
  }
  core::wire::CapabilitiesReply can;
  if (response.status == WireStatus::kWatchOnly &&
      connection().call(MessageKind::kCapabilities).read(can)) {
    throw LinkError(where + why_only_watched(can));
  }
  if (const std::string cause = response.status == WireStatus::kBadValue && range ? range() : "";
      !cause.empty()) {
    throw LinkError(where + cause);
  }
  if (!response.ok()) {
    throw LinkError(where + core::wire::describe(response.status) + details(response) +
                    stiffness_limit(response) + remedy_for(response.status));
  }
  return response;
}

/// The limit of the board, if the refusal is for a larger stiffness. Rounded down, so that the
/// board accepts the stated value.
std::string Board::stiffness_limit(const Response& refusal) const {
  core::wire::CapabilitiesReply can;
  if (!is_too_stiff(refusal) || !connection().call(MessageKind::kCapabilities).read(can)) {
    return "";
  }
  return "; with the present damping the limit is " +
         std::to_string(static_cast<std::uint32_t>(can.stiffness_limit_N_m)) + " N/m";
}

template <core::wire::Message Reply>
Reply Board::fetch(MessageKind kind, const char* what) {
  const Response response = demand(kind, std::span<const std::byte>(), what);
  Reply reply;
  if (!response.read(reply)) {
    throw LinkError(connection().name() + ": " + what + ": the reply is too short");
  }
  return reply;
}

core::wire::IdentifyReply Board::identify() {
  return fetch<core::wire::IdentifyReply>(MessageKind::kIdentify, "identify");
}
core::wire::CapabilitiesReply Board::capabilities() {
  return fetch<core::wire::CapabilitiesReply>(MessageKind::kCapabilities, "capabilities");
}
core::wire::StateReply Board::state() {
  return fetch<core::wire::StateReply>(MessageKind::kState, "state");
}
core::wire::ReadFaultReply Board::first_fault() {
  return fetch<core::wire::ReadFaultReply>(MessageKind::kReadFault, "fault");
}
core::wire::ListModelsReply Board::models() {
  return fetch<core::wire::ListModelsReply>(MessageKind::kListModels, "models");
}

Response Board::control(ControlCode code, std::uint32_t token, const char* what) {
  return demand(MessageKind::kControl, control_request(code, token), what);
}

void Board::require_command(const char* what) { require_command(capabilities(), what); }

void Board::require_command(const core::wire::CapabilitiesReply& can, const char* what) const {
  if (has_flag(can, core::wire::BoardFlag::kWatchOnly)) {
    throw LinkError(connection().name() + ": " + what + ": " + why_only_watched(can));
  }
}

void Board::begin_arming() {
  const core::wire::CapabilitiesReply can = capabilities();
  require_command(can, "arm");
  hand_confirms_ = has_flag(can, core::wire::BoardFlag::kDeadManRequired);
  require_no_fault();
  core::wire::ControlReply armed;
  (void)control(ControlCode::kArm, 0, "arm").read(armed);
  arm_token_ = armed.token;
}

void Board::require_no_fault() {
  const core::wire::StateReply now = state();
  if (static_cast<core::State>(now.state) == core::State::kFault) {
    throw LinkError(connection().name() + ": arm: the board has stopped with the fault " +
                    explain(now.faults) +
                    " (remove the cause, then clear the fault: tactree arm --clear)");
  }
}

bool Board::go_on_arming() {
  const core::wire::StateReply reply = state();
  const auto now = static_cast<core::State>(reply.state);
  if (now == core::State::kActive) {
    return true;
  }
  if (now != core::State::kArmed) {
    const std::string faults = explain(reply.faults);
    throw LinkError(connection().name() + ": arm: the controller is in state " +
                    core::name_of(now) + (faults.empty() ? "" : ": " + faults));
  }
  if (!hand_confirms_) {
    // Has no effect before the amplifiers have power and the probe is outside: the caller repeats
    // it.
    (void)connection().call(MessageKind::kControl,
                            control_request(ControlCode::kConfirm, arm_token_));
  }
  return false;
}

const char* Board::who_confirms() const {
  return hand_confirms_
             ? "release the dead-man control, then press it with the probe outside the object"
             : "hold the probe outside the object";
}

void Board::arm(std::chrono::milliseconds patience) {
  begin_arming();
  const auto deadline = connection().now() + patience;
  while (!go_on_arming()) {
    if (connection().now() > deadline) {
      stop();
      throw LinkError(connection().name() + ": arm: not confirmed (" + who_confirms() + ")");
    }
    connection().sleep(std::chrono::milliseconds(20));
  }
}

void Board::stop() { (void)control(ControlCode::kStop, 0, "stop"); }

void Board::clear_faults() {
  (void)control(ControlCode::kClearFault, 0, "clear faults");
  stop();
}

void Board::home() { (void)control(ControlCode::kHome, 0, "home"); }

void Board::set_limits(float force_max_N, float slew_N_s, float ramp_s) {
  const Range range = [&]() -> std::string {
    const core::wire::CapabilitiesReply can = capabilities();
    if (force_max_N > can.force_limit_N) {
      return outside("limits.force_max_N", force_max_N, 0.01F, can.force_limit_N);
    }
    core::Configuration tried;
    tried.rate_hz = can.rate_hz;
    tried.limits = {force_max_N, slew_N_s, ramp_s};
    const std::string own = range_of(tried);
    return own.empty() && slew_N_s > can.slew_limit_N_s
               ? outside("limits.slew_N_s", slew_N_s, 0.0F, can.slew_limit_N_s)
               : own;
  };
  (void)demand(MessageKind::kSetLimits, core::wire::SetLimitsRequest{force_max_N, slew_N_s, ramp_s},
               "set limits", range);
}

void Board::set_material(const core::wire::SetMaterialRequest& material) {
  (void)demand(MessageKind::kSetMaterial, material, "set material", [&] {
    core::Configuration tried;
    tried.contact.stiffness_N_m = material.stiffness_N_m;
    tried.contact.damping_Ns_m = material.damping_Ns_m;
    tried.contact.static_friction = material.static_friction;
    tried.contact.dynamic_friction = material.dynamic_friction;
    return range_of(tried);
  });
}

void Board::set_texture(const core::wire::SetTextureRequest& texture) {
  (void)demand(MessageKind::kSetTexture, texture, "set texture", [&] {
    core::Configuration tried;
    tried.contact.texture_height_m = texture.height_m;
    tried.contact.texture_wavelength_m = texture.wavelength_m;
    return range_of(tried);
  });
}

void Board::subscribe(const Subscription& subscription) {
  subscription_ = subscription;
  const std::uint32_t known = core::wire::telemetry_fields_of(connection().protocol_minor());
  (void)demand(MessageKind::kSubscribe,
               core::wire::SubscribeRequest{subscription.fields & known, subscription.every_ticks},
               "subscribe");
}

std::vector<TracedTick> Board::trace() {
  return read_trace([this](const core::wire::ReadTraceRequest& request) {
    const Response response = demand(MessageKind::kReadTrace, request, "trace");
    TraceReply reply;
    if (!response.read(reply.header) ||
        response.payload.size() <
            sizeof reply.header + reply.header.count * sizeof(core::FlightRecord)) {
      throw LinkError(connection().name() + ": trace: the reply is too short");
    }
    reply.records.resize(reply.header.count);
    std::memcpy(reply.records.data(), response.payload.data() + sizeof reply.header,
                reply.records.size() * sizeof(core::FlightRecord));
    return reply;
  });
}

std::vector<core::wire::ParameterReply> Board::parameters() {
  std::vector<core::wire::ParameterReply> all(capabilities().parameters);
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (!demand(MessageKind::kGetParameter, core::wire::GetParameterRequest{i}, "parameter")
             .read(all[i])) {
      throw LinkError(connection().name() + ": parameter: the reply is too short");
    }
  }
  return all;
}

void Board::set_parameter(const std::string& name, float value) {
  const std::vector<core::wire::ParameterReply> all = parameters();
  for (const core::wire::ParameterReply& parameter : all) {
    if (name == std::string(parameter.name, ::strnlen(parameter.name, sizeof parameter.name))) {
      (void)demand(MessageKind::kSetParameter,
                   core::wire::SetParameterRequest{parameter.number, value}, "set parameter", [&] {
                     return range_of_parameter(all, parameter, value, capabilities().rate_hz);
                   });
      return;
    }
  }
  throw LinkError(connection().name() + ": no parameter '" + name +
                  "' (tactree params lists them)");
}

core::Vec3 Board::model_origin_m() {
  core::Vec3 origin{};
  for (const core::wire::ParameterReply& parameter : parameters()) {
    const std::string name(parameter.name, ::strnlen(parameter.name, sizeof parameter.name));
    for (const auto& [axis, value] :
         {std::pair{"x", &origin.x}, std::pair{"y", &origin.y}, std::pair{"z", &origin.z}}) {
      if (name == std::string("model_origin_m.") + axis) {
        *value = parameter.value;
      }
    }
  }
  return origin;
}

void Board::save_parameters() {
  (void)demand(MessageKind::kSaveParameters, std::span<const std::byte>(), "save parameters");
}

void Board::write_pieces(std::span<const std::byte> bytes, const Progress& progress) {
  std::size_t offset = 0;
  while (offset < bytes.size()) {
    std::vector<Connection::Request> pieces;
    while (offset < bytes.size() && pieces.size() < kPiecesPerCall) {
      const auto piece = bytes.subspan(
          offset, std::min<std::size_t>(core::wire::kMaxPiece, bytes.size() - offset));
      const core::wire::WriteModelRequest head{static_cast<std::uint32_t>(offset)};
      const auto head_bytes = std::as_bytes(std::span(&head, 1));
      std::vector<std::byte> payload(head_bytes.begin(), head_bytes.end());
      payload.insert(payload.end(), piece.begin(), piece.end());
      pieces.push_back({MessageKind::kWriteModel, std::move(payload)});
      offset += piece.size();
    }
    const Response last = connection().call_all(pieces, kPiecesUnderWay);
    core::wire::WriteModelReply reply;
    const bool knows_place = last.read(reply);
    if (last.timed_out || last.status == WireStatus::kOutOfOrder) {
      // A piece was lost: the board's reply, or one more request, contains the next offset.
      if (!knows_place) {
        const Response asked =
            connection().call(MessageKind::kWriteModel, core::wire::WriteModelRequest{0xFFFFFFFFU});
        if (!asked.read(reply)) {
          throw LinkError(connection().name() + ": write model: no answer");
        }
      }
      offset = std::min<std::size_t>(reply.next_offset, bytes.size());
    } else if (!last.ok()) {
      throw LinkError(connection().name() + ": write model: " + core::wire::describe(last.status) +
                      remedy_for(last.status));
    }
    if (progress) {
      progress(offset, bytes.size());
    }
  }
}

void Board::flash(const ModelFile& model, const Progress& progress) {
  core::wire::BeginModelRequest begin;
  copy(model.board, begin.board);
  begin.counter = model.counter;
  begin.bytes = static_cast<std::uint32_t>(model.bytes.size());
  begin.checksum = core::crc32(model.bytes);
  (void)demand(MessageKind::kBeginModel, begin, "begin model");
  write_pieces(model.bytes, progress);
  core::wire::FinishModelRequest finish;
  finish.is_signed = model.is_signed ? 1U : 0U;
  std::memcpy(finish.signature, model.signature.data(), sizeof finish.signature);
  core::wire::FinishModelReply finished;
  if (!demand(MessageKind::kFinishModel, finish, "check model").read(finished)) {
    throw LinkError(connection().name() + ": check model: the reply is too short");
  }
  (void)demand(MessageKind::kActivateModel, core::wire::SlotRequest{finished.slot}, "use model");
}

void Board::roll_back() {
  (void)demand(MessageKind::kRollBackModel, std::span<const std::byte>(), "roll back");
}

void Board::erase_model(std::uint32_t slot) {
  (void)demand(MessageKind::kEraseModel, core::wire::SlotRequest{slot}, "erase");
}

void Board::post_stop() {
  connection().post(MessageKind::kControl, control_request(ControlCode::kStop, 0));
}

void Board::move_body(std::uint32_t body, const core::Pose& pose, const core::Motion& motion,
                      bool enabled) {
  connection().post(MessageKind::kMoveBody, move_request(body, pose, motion, enabled));
}

void Board::place_body(std::uint32_t body, const core::Pose& pose) {
  (void)demand(MessageKind::kMoveBody, move_request(body, pose, {}, true), "place model");
}

void Board::add_force(const std::array<float, 3>& force_N, std::uint32_t duration_ms) {
  connection().post(MessageKind::kAddForce,
                    core::wire::AddForceRequest{{force_N[0], force_N[1], force_N[2]}, duration_ms});
}

}  // namespace tactree::client
