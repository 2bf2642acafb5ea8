#pragma once
// An application's requests, answered by the board: docs/PROTOCOL.md.
//
// A session works outside the tick. work() does one bounded piece: hands over what waits, encodes a
// telemetry message, or takes one request. What concerns the running controller goes to the tick
// through a TickMailbox; what the controller takes only while the motors are off is done at once,
// with the tick held for that moment.
//
// What keeps a late, repeated or forged message from doing harm:
//   - a request counts once: its sequence number is newer than that of the last one, its session
//     number is the one the board gave out last
//   - from idle to active takes two messages, the second with a token that the reply to the first
//     brought; stop is obeyed always
//   - a required link is kept alive by heartbeats only, and by a heartbeat only as far as it proves
//     that its sender has heard the board a moment ago

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/controller.hpp"
#include "tactree/core/parameters.hpp"
#include "tactree/core/wire/messages.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/session/frame_queue.hpp"
#include "tactree/hal/session/model_transfer.hpp"
#include "tactree/hal/session/reply.hpp"
#include "tactree/hal/session/telemetry.hpp"
#include "tactree/hal/session/tick_mailbox.hpp"
#include "tactree/hal/start_report.hpp"

namespace tactree::hal {

/// What a session needs of its board beyond port and store.
///   now_us()          the Ticker's clock
///   hold_ticks(hold)  no tick begins while held; the ones that were due follow. Held for the time
///                     it takes to load a model or take a configuration, motors off.
template <class T>
concept SessionPlatform = requires(T& platform, bool hold) {
  { platform.now_us() }
  noexcept->std::same_as<std::uint32_t>;
  { platform.hold_ticks(hold) }
  noexcept->std::same_as<void>;
};

/// How a board introduces itself.
struct BoardIdentity {
  const char* board = "";
  const char* firmware = "";
  std::uint32_t serial[3] = {0, 0, 0};
  std::uint32_t cycles_per_second = 0;  ///< 0: not known
};

template <BytePort Port, class Store, SessionPlatform Platform>
class Session {
 public:
  struct Parts {
    Port& port;
    Store& store;
    Platform& platform;
    core::Controller& controller;
    TickMailbox& mailbox;
    const BoardIdentity& identity;
  };

  explicit Session(const Parts& parts)
      : parts_(parts), models_(parts.store, parts.platform, parts.controller, parts.mailbox) {}

  /// What start-up said, and with which configuration: its limits are the greatest that an
  /// application may set. Call it before work(). `report` stays where it is: what the board notices
  /// later is told too.
  void started(const StartResult& result, const core::Configuration& base,
               const StartReport* report = nullptr) {
    start_ = result;
    base_ = base;
    report_ = report;
  }

  /// One piece. True: there may be more to do at once. Cost, without the flash's own time and the
  /// check of a model: a frame in, a frame out, about 30 instructions a byte of them.
  bool work() {
    queue_.flush(parts_.port);
    bool more = send_report();
    end_closed_session();
    if (waiting_) {
      return answer_request() || more;
    }
    return read_request() || more;
  }

 private:
  using Kind = core::wire::MessageKind;
  using WireStatus = core::wire::WireStatus;

  /// What became of a request.
  enum class Outcome : std::uint8_t {
    kAnswer,
    kSilent,
    kLater,  ///< to be handled again: it is not done yet
  };

  static constexpr std::size_t kPiece = 64;

  // ---- frames in and out

  // One request at a time: what came behind it stays in the piece, and in the port.
  bool read_request() {
    if (next_ == end_) {
      next_ = 0;
      end_ = parts_.port.read(std::span(piece_));
    }
    while (next_ < end_) {  // bound: kPiece
      const std::byte byte = piece_[next_];
      ++next_;
      if (decoder_.push(byte) == core::wire::FrameDecoder::Result::kFrame) {
        waiting_ = true;
        step_ = 0;
        (void)answer_request();
        return true;
      }
    }
    return false;
  }

  bool answer_request() {
    if (!queue_.has_room(1)) {
      return false;
    }
    reply_.clear();
    const Outcome outcome = admit();
    waiting_ = outcome == Outcome::kLater;
    if (outcome == Outcome::kAnswer) {
      const core::wire::FrameHeader& request = decoder_.header();
      queue_.push(
          {static_cast<std::uint8_t>(request.kind | core::wire::kReplyBit),
           static_cast<std::uint8_t>(reply_.status()), request.sequence, request.session, 0},
          reply_.payload());
      queue_.flush(parts_.port);
    }
    return !waiting_;
  }

  // A reply never has to wait for telemetry: one frame's room is left for it.
  bool send_report() {
    const TickReport* const report = parts_.mailbox.front();
    if (report == nullptr) {
      return false;
    }
    latest_ = report->status;
    ++reports_;
    if (report->telemetry && fields_ != 0U) {
      send_telemetry(*report);
    }
    parts_.mailbox.pop();
    return true;
  }

  void send_telemetry(const TickReport& report) {
    if (!queue_.has_room(2)) {
      parts_.mailbox.count_dropped();
      return;
    }
    telemetry_.clear();
    put_telemetry(telemetry_,
                  {report.status.tick, report.time_us, fields_, parts_.mailbox.dropped()},
                  report.status);
    ++telemetry_sequence_;
    queue_.push({static_cast<std::uint8_t>(Kind::kTelemetry), 0, telemetry_sequence_, session_, 0},
                telemetry_.payload());
    queue_.flush(parts_.port);
  }

  // ---- who may ask for what

  Outcome admit() {
    const core::wire::FrameHeader& header = decoder_.header();
    const auto kind = static_cast<Kind>(header.kind);
    if (header.kind == 0U || header.kind >= static_cast<std::uint8_t>(Kind::kTelemetry)) {
      return Outcome::kSilent;  // a reply, or an echo of our own
    }
    if (kind == Kind::kIdentify) {
      return identify();
    }
    if (kind == Kind::kReadStart) {
      return tell_start();
    }
    if (kind == Kind::kOpen) {
      return open();
    }
    if (is_stop(kind)) {
      return stop();
    }
    if (session_ == 0U || header.session != session_) {
      return refuse(WireStatus::kNoSession);
    }
    if (step_ == 0U && !is_newer(header.sequence)) {
      return Outcome::kSilent;
    }
    sequence_ = header.sequence;
    const Outcome outcome = handle(kind);
    ++step_;
    return outcome;
  }

  [[nodiscard]] bool is_newer(std::uint16_t sequence) const {
    const auto ahead = static_cast<std::uint16_t>(sequence - sequence_);
    return ahead != 0U && ahead < 0x8000U;
  }

  Outcome handle(Kind kind) {
    switch (kind) {
      case Kind::kClose:
        return close();
      case Kind::kHeartbeat:
        return beat();
      case Kind::kCapabilities:
        return tell_capabilities();
      case Kind::kState:
        return tell_state();
      case Kind::kControl:
        return control();
      case Kind::kSetLimits:
        return set_limits();
      case Kind::kSetMaterial:
        return set_material();
      case Kind::kMoveBody:
        return move_body();
      case Kind::kAddForce:
        return add_force();
      case Kind::kSubscribe:
        return subscribe();
      case Kind::kReadTrace:
        return read_trace();
      case Kind::kReadFault:
        return read_fault();
      case Kind::kGetParameter:
        return get_parameter();
      case Kind::kSetParameter:
        return set_parameter();
      default:
        return handle_models(kind);
    }
  }

  Outcome handle_models(Kind kind) {
    const TransferStep step = models_.handle(kind, decoder_.payload(), step_, reply_);
    return step == TransferStep::kMore ? Outcome::kLater : Outcome::kAnswer;
  }

  Outcome refuse(WireStatus status) {
    reply_.refuse(status);
    return Outcome::kAnswer;
  }

  template <core::wire::Message T>
  [[nodiscard]] bool decode(T& message) {
    if (core::wire::decode_message(decoder_.payload(), message)) {
      return true;
    }
    reply_.refuse(WireStatus::kBadLength);
    return false;
  }

  template <core::wire::Message T>
  Outcome answer(const T& message) {
    reply_.put(message);
    return Outcome::kAnswer;
  }

  // ---- session

  Outcome identify() {
    core::wire::IdentifyReply reply;
    copy(parts_.identity.board, reply.board);
    copy(parts_.identity.firmware, reply.firmware);
    for (std::uint32_t i = 0; i < 3U; ++i) {  // bound: 3
      reply.serial[i] = parts_.identity.serial[i];
    }
    return answer(reply);
  }

  Outcome tell_start() {
    const StartReport report = report_ == nullptr ? StartReport{} : *report_;
    const CapturedFault& fault = report.last_fault;
    core::wire::ReadStartReply reply;
    reply.configuration = static_cast<std::uint8_t>(start_.configuration);
    reply.blob = static_cast<std::uint8_t>(start_.blob);
    reply.model = static_cast<std::uint8_t>(start_.model);
    reply.image = static_cast<std::uint8_t>(start_.image);
    reply.missing = report.missing;
    reply.by_watchdog = report.by_watchdog ? 1U : 0U;
    reply.fault_cause = fault.cause;
    reply.fault_status = fault.status;
    reply.fault_address = fault.address;
    reply.fault_pc = fault.pc;
    reply.fault_lr = fault.lr;
    reply.fault_sp = fault.sp;
    for (std::uint32_t i = 0; i < 13U; ++i) {  // bound: 13
      reply.fault_registers[i] = fault.registers[i];
    }
    return answer(reply);
  }

  // While there may be force a session stays: a repeated or late message must not end it.
  Outcome open() {
    core::wire::OpenRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if (request.version_major != core::wire::kProtocolMajor) {
      return refuse(WireStatus::kBadVersion);
    }
    const bool again = session_ != 0U && request.nonce == nonce_;
    if (!again) {
      const WireStatus status = begin_session(request);
      if (status != WireStatus::kOk) {
        return refuse(status);
      }
    }
    return answer(core::wire::OpenReply{core::wire::kProtocolMajor, minor_, session_, nonce_,
                                        parts_.platform.now_us()});
  }

  WireStatus begin_session(const core::wire::OpenRequest& request) {
    if (!parts_.controller.motors_off()) {
      return WireStatus::kBusy;
    }
    const WireStatus status = require_link(request.link_timeout_ms);
    if (status != WireStatus::kOk) {
      return status;
    }
    parts_.mailbox.subscribe(0);
    models_.release();
    fields_ = 0;
    token_ = 0;
    // Not that of a session before the last reset either.
    const std::uint16_t begin = session_count_ == 0U
                                    ? static_cast<std::uint16_t>(parts_.platform.now_us() >> 4U)
                                    : session_count_;
    session_count_ = static_cast<std::uint16_t>(begin + 1U);
    session_count_ = session_count_ == 0U ? std::uint16_t{1} : session_count_;
    session_ = session_count_;
    nonce_ = request.nonce;
    minor_ = request.version_minor < core::wire::kProtocolMinor ? request.version_minor
                                                                : core::wire::kProtocolMinor;
    sequence_ = decoder_.header().sequence;
    closing_ = false;
    return WireStatus::kOk;
  }

  /// A link that the board itself requires stays required, with the shorter of both times.
  WireStatus require_link(std::uint32_t timeout_ms) {
    core::Adjustment adjustment = parts_.controller.adjustment();
    adjustment.link_required = base_.link_required;
    adjustment.link_timeout_s = base_.link_timeout_s;
    if (timeout_ms != 0U) {
      const float timeout_s = 1e-3F * static_cast<float>(timeout_ms);
      const bool shorter = !base_.link_required || timeout_s < base_.link_timeout_s;
      adjustment.link_required = true;
      adjustment.link_timeout_s = shorter ? timeout_s : base_.link_timeout_s;
    }
    return adjust(adjustment);
  }

  Outcome close() {
    parts_.mailbox.post_stop();
    parts_.mailbox.subscribe(0);
    fields_ = 0;
    session_ = 0;
    closing_ = true;
    models_.release();
    return Outcome::kAnswer;
  }

  // A link that the session required is required until the motors are off.
  void end_closed_session() {
    if (closing_ && parts_.controller.motors_off()) {
      closing_ = false;
      (void)require_link(0);
    }
  }

  // A heartbeat from the future is none; one that is older than the tick counter can say neither.
  Outcome beat() {
    core::wire::HeartbeatRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    const std::uint32_t now_us = parts_.platform.now_us();
    const std::uint32_t age_us = now_us - request.board_time_us;
    const float rate_hz = parts_.controller.configuration().rate_hz;
    // Rounded up, and two more: the next tick takes it, and the controller lets a link be as old as
    // its timeout.
    const float ticks = 1e-6F * static_cast<float>(age_us) * rate_hz + 2.999F;
    if (age_us < 0x80000000U && ticks < 65535.0F) {
      parts_.mailbox.post_sign_of_life(static_cast<std::uint16_t>(ticks));
    }
    return answer(core::wire::HeartbeatReply{now_us, age_us});
  }

  // ---- capabilities, state, control

  Outcome tell_capabilities() {
    const core::Configuration& c = parts_.controller.configuration();
    core::wire::CapabilitiesReply reply;
    reply.rate_hz = c.rate_hz;
    reply.force_max_N = c.force_max_N;
    reply.force_limit_N = base_.force_max_N;
    reply.slew_N_s = c.slew_N_s;
    reply.slew_limit_N_s = base_.slew_N_s;
    reply.host_force_max_N = core::kAddedForceShare * c.force_max_N;
    reply.stiffness_N_m = c.stiffness_N_m;
    reply.stiffness_limit_N_m = core::stability_limit(c).with_hand_N_m;
    reply.bodies_max = core::kMaxBodies;
    for (std::uint32_t i = 0; i < core::kMaxBodies; ++i) {  // bound: kMaxBodies
      reply.bodies |= parts_.controller.has_body(i) ? 1U << i : 0U;
    }
    reply.slots = Store::kSlots;
    reply.slot_bytes = parts_.store.slot_bytes();
    reply.flags = flags(c);
    reply.trace_ticks = core::FlightRecorder::kTicks;
    reply.parameters = core::kParameters;
    reply.cycles_per_tick =
        static_cast<std::uint32_t>(static_cast<float>(parts_.identity.cycles_per_second) /
                                   (c.rate_hz > 0.0F ? c.rate_hz : 1.0F));
    return answer(reply);
  }

  [[nodiscard]] std::uint32_t flags(const core::Configuration& c) const {
    const auto flag = [](bool on, core::wire::BoardFlag bit) {
      return on ? static_cast<std::uint32_t>(bit) : 0U;
    };
    return flag(parts_.store.signature_required(), core::wire::BoardFlag::kSignatureRequired) |
           flag(c.dead_man_required, core::wire::BoardFlag::kDeadManRequired) |
           flag(c.link_required, core::wire::BoardFlag::kLinkRequired) |
           flag(parts_.controller.homed(), core::wire::BoardFlag::kHomed);
  }

  /// True: a tick's status has come that was asked for in the first step.
  [[nodiscard]] bool has_fresh_status() {
    if (step_ == 0U) {
      reports_before_ = reports_;
      parts_.mailbox.ask();
      return false;
    }
    return reports_ != reports_before_;
  }

  Outcome tell_state() {
    if (!has_fresh_status()) {
      return Outcome::kLater;
    }
    core::wire::StateReply reply;
    reply.tick = latest_.tick;
    reply.state = static_cast<std::uint8_t>(latest_.state);
    reply.configuration = static_cast<std::uint8_t>(start_.configuration);
    reply.blob = static_cast<std::uint8_t>(start_.blob);
    reply.model = static_cast<std::uint8_t>(start_.model);
    reply.faults = latest_.faults;
    reply.limits = latest_.limits;
    reply.overruns = latest_.overruns;
    reply.board_time_us = parts_.platform.now_us();
    copy(latest_.probe, reply.probe_m);
    copy(latest_.force, reply.force_N);
    return answer(reply);
  }

  [[nodiscard]] bool is_stop(Kind kind) const {
    core::wire::ControlRequest request;
    return kind == Kind::kControl && core::wire::decode_message(decoder_.payload(), request) &&
           request.code == static_cast<std::uint8_t>(core::wire::ControlCode::kStop);
  }

  // Whoever asks, and however late: it only takes force away. Its number still uses up its place,
  // so that an arm that was sent before it and comes after it is old.
  Outcome stop() {
    const core::wire::FrameHeader& header = decoder_.header();
    if (step_ == 0U) {
      if (header.session == session_ && is_newer(header.sequence)) {
        sequence_ = header.sequence;
      }
      token_ = 0;
      parts_.mailbox.post_stop();
    }
    return finish_command();
  }

  Outcome control() {
    core::wire::ControlRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if (step_ > 0U) {
      return finish_command();
    }
    const auto code = static_cast<core::wire::ControlCode>(request.code);
    core::Command command = core::Command::kNone;
    const WireStatus status = translate(code, request.token, command);
    if (status != WireStatus::kOk) {
      return refuse(status);
    }
    if (command != core::Command::kNone && !parts_.mailbox.post_command(command)) {
      return refuse(WireStatus::kQueueFull);
    }
    return finish_command();
  }

  /// The controller's command for a code, where the state allows it: a command that it does not is
  /// a fault for the controller, and here an answer. kNone: nothing is to be done.
  WireStatus translate(core::wire::ControlCode code, std::uint32_t token, core::Command& command) {
    const core::State state = parts_.controller.state();
    if (code == core::wire::ControlCode::kArm) {
      return arm(state, command);
    }
    if (code == core::wire::ControlCode::kConfirm) {
      return confirm(state, token, command);
    }
    if (code == core::wire::ControlCode::kClearFault) {
      command = core::Command::kClearFault;
      return WireStatus::kOk;
    }
    if (code != core::wire::ControlCode::kHome) {
      return WireStatus::kBadValue;
    }
    command = core::Command::kHome;
    return parts_.controller.motors_off() ? WireStatus::kOk : WireStatus::kBusy;
  }

  // Where it is armed already the token is told once more, for whom the first reply did not reach.
  WireStatus arm(core::State state, core::Command& command) {
    if (state == core::State::kArmed && token_ != 0U) {
      return WireStatus::kOk;
    }
    if (state != core::State::kIdle) {
      return WireStatus::kNotNow;
    }
    if (models_.is_writing()) {
      return WireStatus::kBusy;
    }
    command = core::Command::kArm;
    token_ = make_token();
    return WireStatus::kOk;
  }

  WireStatus confirm(core::State state, std::uint32_t token, core::Command& command) const {
    if (parts_.controller.configuration().dead_man_required) {
      return WireStatus::kNotNow;  // that is for the hand to say
    }
    if (state != core::State::kArmed) {
      return WireStatus::kNotNow;
    }
    if (token == 0U || token != token_) {
      return WireStatus::kBadToken;
    }
    command = core::Command::kArm;
    return WireStatus::kOk;
  }

  /// Different each time, and never 0: no secret, but nothing that is sent by mistake.
  std::uint32_t make_token() {
    ++tokens_;
    const std::uint32_t words[3] = {parts_.platform.now_us(), tokens_, session_};
    const std::uint32_t token = core::crc32(std::as_bytes(std::span(words)));
    return token == 0U ? 1U : token;
  }

  Outcome finish_command() {
    const bool done = has_fresh_status();
    if (step_ == 0U || !done) {
      ++step_;  // stop() and control() come here first with step 0
      return Outcome::kLater;
    }
    core::wire::ControlReply reply;
    reply.state = static_cast<std::uint8_t>(latest_.state);
    reply.faults = latest_.faults;
    reply.token = latest_.state == core::State::kArmed ? token_ : 0U;
    return answer(reply);
  }

  // ---- what the hand feels

  WireStatus adjust(const core::Adjustment& adjustment) {
    parts_.platform.hold_ticks(true);
    const core::ConfigurationStatus status = parts_.controller.adjust(adjustment);
    parts_.platform.hold_ticks(false);
    switch (status) {
      case core::ConfigurationStatus::kOk:
        return WireStatus::kOk;
      case core::ConfigurationStatus::kBusy:
        return WireStatus::kBusy;
      case core::ConfigurationStatus::kUnstable:
        return WireStatus::kUnstable;
      default:
        return WireStatus::kBadValue;
    }
  }

  Outcome set_limits() {
    core::wire::SetLimitsRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if (!(request.force_max_N <= base_.force_max_N) || !(request.slew_N_s <= base_.slew_N_s)) {
      return refuse(WireStatus::kBadValue);
    }
    core::Adjustment adjustment = parts_.controller.adjustment();
    adjustment.force_max_N = request.force_max_N;
    adjustment.slew_N_s = request.slew_N_s;
    adjustment.ramp_s = request.ramp_s;
    return refuse(adjust(adjustment));
  }

  Outcome set_material() {
    core::wire::SetMaterialRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    core::Adjustment adjustment = parts_.controller.adjustment();
    adjustment.stiffness_N_m = request.stiffness_N_m;
    adjustment.damping_Ns_m = request.damping_Ns_m;
    adjustment.static_friction = request.static_friction;
    adjustment.dynamic_friction = request.dynamic_friction;
    adjustment.use_materials = request.use_materials != 0U;
    return refuse(adjust(adjustment));
  }

  Outcome move_body() {
    core::wire::MoveBodyRequest r;
    if (!decode(r)) {
      return Outcome::kAnswer;
    }
    const BodyUpdate update{
        r.body,
        r.enabled != 0U,
        {{r.rotation_wxyz[0], vector(&r.rotation_wxyz[1])}, vector(r.translation_m)},
        {vector(r.linear_m_s), vector(r.angular_rad_s)}};
    const bool good = r.body < core::kMaxBodies && parts_.controller.has_body(r.body) &&
                      core::is_valid(update.pose) && core::is_valid(update.motion);
    if (!good) {
      return refuse(WireStatus::kBadValue);
    }
    return parts_.mailbox.post_body(update) ? Outcome::kAnswer : Outcome::kLater;
  }

  Outcome add_force() {
    core::wire::AddForceRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    const core::Vec3 force = vector(request.force_N);
    const auto longest = static_cast<std::uint32_t>(1e3F * core::kAddedForceSeconds);
    if (!core::is_finite(force) || request.duration_ms == 0U || request.duration_ms > longest) {
      return refuse(WireStatus::kBadValue);
    }
    if (parts_.controller.state() != core::State::kActive) {
      return refuse(WireStatus::kNotNow);
    }
    const float ticks =
        1e-3F * static_cast<float>(request.duration_ms) * parts_.controller.configuration().rate_hz;
    parts_.mailbox.post_force({force, static_cast<std::uint32_t>(ticks < 1.0F ? 1.0F : ticks)});
    return Outcome::kAnswer;
  }

  Outcome subscribe() {
    core::wire::SubscribeRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if ((request.fields & ~kAllTelemetry) != 0U) {
      return refuse(WireStatus::kBadValue);
    }
    fields_ = request.decimation == 0U ? 0U : request.fields;
    parts_.mailbox.subscribe(fields_ == 0U ? 0U : request.decimation);
    return Outcome::kAnswer;
  }

  // ---- trace, parameters

  // The records lie still while the ticks are held.
  Outcome read_trace() {
    core::wire::ReadTraceRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if (request.count == 0U || request.count > core::wire::kMaxTraceRecords) {
      return refuse(WireStatus::kBadValue);
    }
    parts_.platform.hold_ticks(true);
    const core::FlightRecorder& recorder = parts_.controller.recorder();
    const std::uint32_t total = recorder.count();
    const std::uint32_t left = request.age < total ? total - request.age : 0U;
    const std::uint32_t count = left < request.count ? left : request.count;
    reply_.put(core::wire::ReadTraceReply{recorder.last_tick(), total, request.age, count});
    for (std::uint32_t i = 0; i < count; ++i) {  // bound: kMaxTraceRecords
      reply_.append(std::as_bytes(std::span(&recorder.record(request.age + i), 1)));
    }
    parts_.platform.hold_ticks(false);
    return Outcome::kAnswer;
  }

  Outcome read_fault() {
    parts_.platform.hold_ticks(true);
    const core::FaultSnapshot snapshot = parts_.controller.recorder().snapshot();
    parts_.platform.hold_ticks(false);
    core::wire::ReadFaultReply reply;
    reply.faults = snapshot.faults;
    reply.tick = snapshot.tick;
    copy(snapshot.probe, reply.probe_m);
    copy(snapshot.proxy, reply.proxy_m);
    copy(snapshot.velocity, reply.velocity_m_s);
    copy(snapshot.force, reply.force_N);
    return answer(reply);
  }

  Outcome get_parameter() {
    core::wire::GetParameterRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    return tell_parameter(request.number);
  }

  Outcome tell_parameter(std::uint32_t number) {
    if (number >= core::kParameters) {
      return refuse(WireStatus::kBadValue);
    }
    const core::Parameter parameter = core::parameter(number);
    core::wire::ParameterReply reply;
    reply.number = number;
    reply.value = core::parameter_of(parts_.controller.configuration(), number);
    reply.min = parameter.min;
    reply.max = parameter.max;
    copy(parameter.name, reply.name);
    return answer(reply);
  }

  // A device of other figures has to be homed again, and its models are checked again.
  Outcome set_parameter() {
    core::wire::SetParameterRequest request;
    if (!decode(request)) {
      return Outcome::kAnswer;
    }
    if (!parts_.controller.motors_off()) {
      return refuse(WireStatus::kBusy);
    }
    core::Configuration changed = parts_.controller.configuration();
    if (request.number >= core::kParameters ||
        !core::set_parameter(changed, request.number, request.value)) {
      return refuse(WireStatus::kBadValue);
    }
    parts_.platform.hold_ticks(true);
    const core::ConfigurationStatus status = parts_.controller.configure(changed);
    parts_.platform.hold_ticks(false);
    if (status != core::ConfigurationStatus::kOk) {
      return refuse(status == core::ConfigurationStatus::kUnstable ? WireStatus::kUnstable
                                                                   : WireStatus::kBadValue);
    }
    return tell_parameter(request.number);
  }

  // ---- small things

  static core::Vec3 vector(const float* components) {
    return {components[0], components[1], components[2]};
  }
  static void copy(core::Vec3 from, float (&to)[3]) {
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
  }
  template <std::size_t N>
  static void copy(const char* from, char (&to)[N]) {
    for (std::size_t i = 0; i + 1 < N && from[i] != '\0'; ++i) {  // bound: N
      to[i] = from[i];
    }
  }

  Parts parts_;
  ModelTransfer<Store, Platform> models_;
  core::Configuration base_{};
  StartResult start_{};
  const StartReport* report_ = nullptr;  // nullptr: the board tells nothing

  core::wire::FrameDecoder decoder_{};
  FrameQueue queue_{};
  Reply reply_{};
  Reply telemetry_{};
  std::byte piece_[kPiece] = {};
  std::size_t next_ = 0;
  std::size_t end_ = 0;
  bool waiting_ = false;    // the request in decoder_ is not done yet
  std::uint32_t step_ = 0;  // times it was handled

  std::uint16_t session_ = 0;  // 0: there is none
  std::uint16_t session_count_ = 0;
  std::uint16_t sequence_ = 0;  // of the last request that counted
  std::uint16_t telemetry_sequence_ = 0;
  std::uint8_t minor_ = 0;
  bool closing_ = false;
  std::uint32_t nonce_ = 0;
  std::uint32_t token_ = 0;  // of the last arming; 0: none
  std::uint32_t tokens_ = 0;
  std::uint32_t fields_ = 0;

  core::Status latest_{};
  std::uint32_t reports_ = 0;
  std::uint32_t reports_before_ = 0;
};

}  // namespace tactree::hal
