#pragma once
// Serves the requests of an application on a board: docs/PROTOCOL.md. The session reads frames from
// the port, checks session and sequence numbers, calls the handler of each request and sends its
// reply; telemetry is sent in between. The handlers are in the other headers of this folder.
//
// A session works between ticks. It accesses the running controller only
//   through TickMailbox       commands, body updates, forces, heartbeats; reports of ticks
//   through BetweenTicks      all changes of the controller (configure, adjust, load_model), and
//                             reads of more than one word that a tick writes (the flight recorder)
//   directly, at any time     state(), motors_off(), homed() and faults(), which are one word each;
//                             has_body() and configuration(), which only this context changes
//
// Protection against late, repeated or forged messages:
//   - A request counts once: its sequence number must be newer than that of the last request, and
//     its session number must be the one that the board assigned last.
//   - The transition from idle to active requires two messages; the second returns a token from the
//     reply to the first. Stop is always obeyed.
//   - Only heartbeats keep a required link alive. The age of the link is measured from the newest
//     board time that a heartbeat contains, so old heartbeats do not keep it alive.
//   - A session that required its link and is silent for kSilenceUs ends, once the motors are off:
//     an unplugged application does not keep a board from being operated by its button.
// Loop and memory annotations: docs/BOUND.md.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactree/core/control/between_ticks.hpp"
#include "tactree/core/control/controller.hpp"
#include "tactree/core/link/wire/messages.hpp"
#include "tactree/hal/board.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/hal/start_report.hpp"
#include "tactree/session/board_report.hpp"
#include "tactree/session/contact_requests.hpp"
#include "tactree/session/control_requests.hpp"
#include "tactree/session/frame_queue.hpp"
#include "tactree/session/model_transfer.hpp"
#include "tactree/session/parameter_requests.hpp"
#include "tactree/session/platform.hpp"
#include "tactree/session/reply.hpp"
#include "tactree/session/request_filter.hpp"
#include "tactree/session/telemetry_sender.hpp"
#include "tactree/session/tick_mailbox.hpp"
#include "tactree/session/trace_requests.hpp"

namespace tactree::session {

template <hal::BytePort Port, class Store, SessionPlatform Platform>
class Session {
 public:
  /// The session keeps all of these references.
  struct Parts {
    Port& port;
    Store& store;
    Platform& platform;
    core::Controller& controller;
    TickMailbox& mailbox;
    const BoardIdentity& identity;
  };

  explicit Session(const Parts& parts)
      : port_(parts.port),
        store_(parts.store),
        platform_(parts.platform),
        changes_(parts.controller, parts.platform),
        mailbox_(parts.mailbox),
        identity_(parts.identity),
        control_(parts.controller, parts.mailbox),
        telemetry_(parts.mailbox),
        models_(parts.store, changes_, parts.mailbox) {}

  /// Call before work(). `base`: configuration at the start, whose force and slew limits are the
  /// upper bounds of what an application may set. `report` must outlive the session; entries added
  /// later are reported, too.
  void started(const hal::StartResult& result, const core::Configuration& base,
               const hal::StartReport* report = nullptr) {
    start_ = result;
    base_ = base;
    start_report_ = report;
  }

  /// One bounded unit of work: sends queued frames, encodes at most one telemetry message and
  /// handles at most one request. Returns true if it should be called again immediately. Cost,
  /// without flash operations and the check of a model: one frame in and one out, about 30
  /// instructions per byte.
  bool work() {
    queue_.flush(port_);
    const bool more = send_report();
    end_silent_session();
    end_closed_session();
    if (waiting_) {
      return answer_request() || more;
    }
    return read_request() || more;
  }

 private:
  using Kind = core::wire::MessageKind;
  using WireStatus = core::wire::WireStatus;

  // Bytes read from the port at once: a full-speed USB packet. More would only move the wait from
  // the port to here.
  static constexpr std::size_t kPiece = 64;

  // A required link has a heartbeat at least every 0.1 s. The computer of an application may stand
  // still for seconds.
  static constexpr std::uint32_t kSilenceUs = 10'000'000;

  [[nodiscard]] const core::Controller& controller() const { return changes_.controller(); }

  [[nodiscard]] bool may_command() const { return controller().configuration().link.may_command; }

  // ---- frames in and out

  // Handles one request at a time: the bytes that follow it stay in piece_ and in the port.
  bool read_request() {
    if (next_ == end_) {
      next_ = 0;
      end_ = port_.read(std::span(piece_));
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
    ++step_;
    if (outcome == Outcome::kAnswer) {
      const core::wire::FrameHeader& request = decoder_.header();
      queue_.push(
          {static_cast<std::uint8_t>(request.kind | core::wire::kReplyBit),
           static_cast<std::uint8_t>(reply_.status()), request.sequence, request.session, 0},
          reply_.payload());
      queue_.flush(port_);
    }
    return !waiting_;
  }

  bool send_report() {
    const TickReport* const report = mailbox_.front();
    if (report == nullptr) {
      return false;
    }
    fresh_.note(*report);
    telemetry_.send(*report, filter_.session(), queue_);
    mailbox_.pop();
    queue_.flush(port_);
    return true;
  }

  // ---- admission

  Outcome admit() {
    const core::wire::FrameHeader& header = decoder_.header();
    const auto kind = static_cast<Kind>(header.kind);
    if (header.kind == 0U || header.kind >= static_cast<std::uint8_t>(Kind::kTelemetry)) {
      return Outcome::kSilent;  // a reply, or an echo of the board's frames
    }
    if (kind == Kind::kIdentify) {
      put_identity(identity_, reply_);
      return Outcome::kAnswer;
    }
    if (kind == Kind::kReadStart) {
      put_start(start_, start_report_ == nullptr ? hal::StartReport{} : *start_report_, reply_);
      return Outcome::kAnswer;
    }
    if (kind == Kind::kCapabilities && header.session == 0U) {
      return capabilities();
    }
    if (kind == Kind::kOpen) {
      return answer(open());
    }
    if (ControlRequests::is_stop(kind, decoder_.payload())) {
      return stop();
    }
    switch (filter_.admit(header, step_ > 0U)) {
      case RequestFilter::Verdict::kNoSession:
        return answer(WireStatus::kNoSession);
      case RequestFilter::Verdict::kRepeated:
        return Outcome::kSilent;
      case RequestFilter::Verdict::kAdmitted:
        break;
    }
    heard_us_ = platform_.now_us();
    return handle(kind);
  }

  Outcome answer(WireStatus status) {
    reply_.set_status(status);
    return Outcome::kAnswer;
  }

  Outcome handle(Kind kind) {
    if (!may_command() && !is_watching(kind)) {
      return answer(filter_.known(WireStatus::kWatchOnly));
    }
    switch (kind) {
      case Kind::kClose:
        return close();
      case Kind::kHeartbeat:
        return answer(heartbeat());
      case Kind::kCapabilities:
        return capabilities();
      case Kind::kState:
        return state();
      case Kind::kControl:
        return control();
      case Kind::kMoveBody:
        return move_body(decoder_.payload(), controller(), mailbox_, reply_);
      case Kind::kAddForce:
        return answer(add_force(decoder_.payload(), controller(), mailbox_));
      case Kind::kSubscribe:
        return answer(telemetry_.subscribe(decoder_.payload()));
      case Kind::kGetParameter:
        return answer(get_parameter(decoder_.payload(), controller(), reply_));
      case Kind::kSetLimits:
        return answer(set_limits());
      case Kind::kSetMaterial:
        return answer(set_material());
      case Kind::kSetTexture:
        return answer(set_texture());
      case Kind::kSetParameter:
        return answer(set_parameter());
      case Kind::kReadTrace:
      case Kind::kReadFault:
        return answer(read_recorder(kind));
      default:
        return models_.handle(kind, decoder_.payload(), step_, reply_);
    }
  }

  // Not inlined, like the other changes: their data is on the stack only where it is needed.
  [[gnu::noinline]] WireStatus set_limits() {
    core::Adjustment adjustment;
    const WireStatus status = limits_of(decoder_.payload(), controller(), base_, adjustment);
    return adjust(status, adjustment);
  }

  [[gnu::noinline]] WireStatus set_material() {
    core::Adjustment adjustment;
    const WireStatus status = material_of(decoder_.payload(), controller(), adjustment);
    return adjust(status, adjustment);
  }

  [[gnu::noinline]] WireStatus set_texture() {
    core::Adjustment adjustment;
    const WireStatus status = texture_of(decoder_.payload(), controller(), adjustment);
    return adjust(status, adjustment);
  }

  WireStatus adjust(WireStatus status, const core::Adjustment& adjustment) {
    return status == WireStatus::kOk ? to_wire(changes_.adjust(adjustment)) : status;
  }

  /// The device must be homed again afterwards, and its models are checked again.
  [[gnu::noinline]] WireStatus set_parameter() {
    core::wire::SetParameterRequest request;
    core::Configuration changed;
    WireStatus status = parameter_change(decoder_.payload(), controller(), request, changed);
    if (status == WireStatus::kOk) {
      status = to_wire(changes_.configure(changed));
    }
    if (status == WireStatus::kOk) {
      put_parameter(request.number, controller(), reply_);
    }
    return status;
  }

  /// Ticks are held during the read, because they write the recorder.
  WireStatus read_recorder(Kind kind) {
    return changes_.read([&](const core::Controller& held) {
      if (kind == Kind::kReadTrace) {
        return read_trace(decoder_.payload(), held.recorder(), reply_);
      }
      read_fault(held.recorder(), reply_);
      return WireStatus::kOk;
    });
  }

  // ---- opening and closing a session

  // No other session is opened while armed or active: a repeated or late message must not end the
  // session. One that may only watch is opened at any time, and its link is not required: it comes
  // and goes without effect on the force.
  WireStatus open() {
    core::wire::OpenRequest request;
    if (!core::wire::decode_message(decoder_.payload(), request)) {
      return WireStatus::kBadLength;
    }
    if (request.version_major != core::wire::kProtocolMajor) {
      return WireStatus::kBadVersion;
    }
    if (!filter_.has_opened(request)) {
      const WireStatus status = begin_session(request);
      if (status != WireStatus::kOk) {
        return status;
      }
    }
    reply_.put(filter_.opening(platform_.now_us()));
    return WireStatus::kOk;
  }

  WireStatus begin_session(const core::wire::OpenRequest& request) {
    if (may_command()) {
      if (!controller().motors_off()) {
        return WireStatus::kBusy;
      }
      const WireStatus status = require_link(request.link_timeout_ms);
      if (status != WireStatus::kOk) {
        return status;
      }
    }
    telemetry_.unsubscribe();
    models_.release();
    control_.reset();
    heard_us_ = platform_.now_us();
    filter_.open(request, decoder_.header().sequence, heard_us_);
    requires_link_ = request.link_timeout_ms != 0U;
    closing_ = false;
    return WireStatus::kOk;
  }

  [[gnu::noinline]] WireStatus require_link(std::uint32_t timeout_ms) {
    return to_wire(changes_.adjust(with_link(controller().adjustment(), base_, timeout_ms)));
  }

  Outcome close() {
    if (may_command()) {
      mailbox_.post_stop();
    }
    end_session();
    return Outcome::kAnswer;
  }

  void end_session() {
    closing_ = may_command();
    telemetry_.unsubscribe();
    filter_.close();
    models_.release();
  }

  void end_silent_session() {
    const bool may_end = filter_.session() != 0U && requires_link_ && controller().motors_off();
    if (may_end && platform_.now_us() - heard_us_ >= kSilenceUs) {
      end_session();
    }
  }

  // A link that a closed session required stays required until the motors are off.
  void end_closed_session() {
    if (closing_ && controller().motors_off()) {
      closing_ = false;
      (void)require_link(0);
    }
  }

  WireStatus heartbeat() {
    core::wire::HeartbeatRequest request;
    if (!core::wire::decode_message(decoder_.payload(), request)) {
      return WireStatus::kBadLength;
    }
    const std::uint32_t now_us = platform_.now_us();
    const std::uint32_t age_us = now_us - request.board_time_us;
    std::uint16_t ticks = 0;
    if (link_age(age_us, controller().configuration().rate_hz, ticks)) {
      mailbox_.post_sign_of_life(ticks);
    }
    reply_.put(core::wire::HeartbeatReply{now_us, age_us});
    return WireStatus::kOk;
  }

  [[gnu::noinline]] Outcome capabilities() {
    put_capabilities(controller(), base_,
                     {Store::kSlots, store_.slot_bytes(), store_.signature_required()},
                     identity_.cycles_per_second, reply_);
    return Outcome::kAnswer;
  }

  // ---- requests that are answered with the status of a later tick

  /// Requests a status in the first step. Returns true in a later step, once it has arrived.
  [[nodiscard]] bool has_fresh_status() {
    if (step_ == 0U) {
      fresh_.request(mailbox_);
      return false;
    }
    return fresh_.has_come();
  }

  Outcome state() {
    if (!has_fresh_status()) {
      return Outcome::kLater;
    }
    put_state(fresh_.get(), start_, platform_.now_us(), reply_);
    return Outcome::kAnswer;
  }

  // A stop is obeyed from any sender, however late, because it only removes force.
  Outcome stop() {
    if (step_ == 0U) {
      filter_.note_stop(decoder_.header());
      control_.stop();
    }
    return finish_command();
  }

  Outcome control() {
    if (step_ == 0U) {
      const WireStatus status = control_.post(
          decoder_.payload(), {platform_.now_us(), filter_.session(), models_.is_writing()});
      if (status != WireStatus::kOk) {
        return answer(filter_.known(status));
      }
    }
    return finish_command();
  }

  Outcome finish_command() {
    if (!has_fresh_status()) {
      return Outcome::kLater;
    }
    control_.put_reply(fresh_.get(), reply_);
    return Outcome::kAnswer;
  }

  Port& port_;
  Store& store_;
  Platform& platform_;
  core::BetweenTicks<Platform> changes_;
  TickMailbox& mailbox_;
  const BoardIdentity& identity_;
  RequestFilter filter_{};
  ControlRequests control_;
  FreshStatus fresh_{};
  TelemetrySender telemetry_;
  ModelTransfer<Store, Platform> models_;
  core::Configuration base_{};
  hal::StartResult start_{};
  const hal::StartReport* start_report_ = nullptr;

  core::wire::FrameDecoder decoder_{};
  FrameQueue queue_{};
  Reply reply_{};
  std::byte piece_[kPiece] = {};
  std::size_t next_ = 0;  // next byte in piece_
  std::size_t end_ = 0;
  bool waiting_ = false;    // the request in decoder_ is not finished
  std::uint32_t step_ = 0;  // calls of its handler so far

  std::uint32_t heard_us_ = 0;  // time of the last admitted request
  bool requires_link_ = false;  // the session asked for it
  bool closing_ = false;        // the session has ended, but its link is still required
};

}  // namespace tactree::session
