#include "tactree/share/shared_board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include "tactree/client/link_error.hpp"
#include "tactree/client/ports.hpp"
#include "tactree/core/control/force_stage.hpp"
#include "tactree/telemetry/tick_table.hpp"

namespace tactree::share {
namespace {

using core::wire::TelemetryField;
using std::chrono::microseconds;

constexpr std::size_t kMaxRequests = 64;
constexpr auto kForceDuration_ms = static_cast<std::uint32_t>(1e3F * core::kAddedForceSeconds);
// More than all watching programs may have.
constexpr std::size_t kMaxBoardQuestions = 256;
// A request waits for this long at most; new telemetry ends the wait.
constexpr std::chrono::milliseconds kMaxWait{10};
constexpr std::chrono::seconds kMaxSilence{2};
// Counts as silence in one pass at most: this program may have stood still, not the board.
constexpr microseconds kMaxCounted{100'000};
constexpr std::chrono::milliseconds kRetryInterval{200};
constexpr std::chrono::milliseconds kLookInterval{20};
constexpr std::chrono::seconds kConfirmTimeout{30};  // the default of tactree arm

// What the messages of the WebSocket have.
constexpr std::uint32_t kFields = static_cast<std::uint32_t>(TelemetryField::kState) |
                                  static_cast<std::uint32_t>(TelemetryField::kProbe) |
                                  static_cast<std::uint32_t>(TelemetryField::kVelocity) |
                                  static_cast<std::uint32_t>(TelemetryField::kForce) |
                                  static_cast<std::uint32_t>(TelemetryField::kProxy) |
                                  static_cast<std::uint32_t>(TelemetryField::kNormal) |
                                  static_cast<std::uint32_t>(TelemetryField::kContact) |
                                  static_cast<std::uint32_t>(TelemetryField::kTiming);

template <std::size_t N>
std::string field_text(const char (&field)[N]) {
  return {field, ::strnlen(field, N)};
}

std::string id_of(const core::wire::IdentifyReply& identity) {
  const auto& serial = identity.serial;
  const bool has_serial = serial[0] != 0U || serial[1] != 0U || serial[2] != 0U;
  return has_serial ? fmt::format("{:08x}{:08x}{:08x}", serial[0], serial[1], serial[2])
                    : field_text(identity.board);
}

client::Response no_reply(core::wire::MessageKind kind) {
  client::Response response;
  response.kind = kind;
  response.timed_out = true;
  return response;
}

}  // namespace

SharedBoard::SharedBoard(BoardSettings settings)
    : settings_(std::move(settings)), board_(settings_.port, settings_.link) {
  begin_session();
  name_ = snapshot_.board->name;
  if (settings_.arm) {
    board_.arm();
  }
}

SharedBoard::~SharedBoard() { end(); }

void SharedBoard::begin_session() {
  const auto description = std::make_shared<const Description>(describe());
  board_.subscribe(subscription(*description));
  snapshot_.board = description;
  snapshot_.link = Link::kHere;
  snapshot_.why.clear();
  has_tick_ = false;
  last_pass_ = board_.connection().now();
  silence_ = {};
}

Description SharedBoard::describe() {
  const core::wire::IdentifyReply identity = board_.identify();
  Description description;
  description.device_id = id_of(identity);
  description.name = field_text(identity.board);
  description.firmware = field_text(identity.firmware);
  description.can = board_.capabilities();
  description.origin_m = board_.model_origin_m();
  add_model(description);
  return description;
}

/// A board reports size and checksum of a model that was written to it, but no name.
void SharedBoard::add_model(Description& description) {
  const core::wire::ListModelsReply list =
      description.can.slots == 0U ? core::wire::ListModelsReply{} : board_.models();
  const auto* const in_use =
      std::find_if(std::begin(list.slot), std::end(list.slot), [](const auto& slot) {
        return slot.state == static_cast<std::uint8_t>(core::wire::SlotState::kActive);
      });
  const bool reports_model = in_use != std::end(list.slot);
  if (reports_model) {
    description.model_points = in_use->points;
  }
  if (!settings_.model) {
    return;
  }
  const KnownModel& known = *settings_.model;
  if (reports_model && (in_use->bytes != known.bytes || in_use->checksum != known.checksum)) {
    settings_.tell(fmt::format(
        "warning: the board uses a model other than {} ({} points, {} bytes), whose name is "
        "unknown (give the board's model, or write this one with tactree flash)",
        known.name, in_use->points, in_use->bytes));
    return;
  }
  description.model_name = known.name;
  description.model_points = known.points;
}

/// Every tick with all fields; at a serial line what the WebSocket needs, as often as fills half of
/// its capacity.
client::Subscription SharedBoard::subscription(const Description& description) const {
  const std::optional<unsigned> bytes_s = client::wire_speed(settings_.port, settings_.link.baud);
  if (!bytes_s) {
    return {core::wire::telemetry_fields_of(board_.connection().protocol_minor()), 1U};
  }
  const double messages_s =
      std::max(1.0, 0.5 * *bytes_s / static_cast<double>(telemetry::frame_bytes(kFields)));
  return {kFields, static_cast<std::uint32_t>(std::max(
                       1.0, std::ceil(static_cast<double>(description.can.rate_hz) / messages_s)))};
}

void SharedBoard::start(Publish publish) {
  publish_ = std::move(publish);
  running_ = true;
  thread_ = std::thread([this] { run(); });
}

void SharedBoard::end() {
  running_ = false;
  if (thread_.joinable()) {
    thread_.join();
  }
}

// For the thread of the clients

void SharedBoard::add_force(const std::array<float, 3>& force_N) {
  const std::unique_lock lock(connecting_, std::try_to_lock);
  if (lock.owns_lock() && board_.connected()) {
    board_.add_force(force_N, kForceDuration_ms);
  }
}

// Bypasses the requests. The stop is sent at once, and again by the board's thread until the board
// confirms that it has stopped.
void SharedBoard::stop() {
  {
    const std::lock_guard lock(mutex_);
    std::erase(requests_, BoardRequest::kArm);  // none may start the board again
  }
  stop_wanted_ = true;
  const std::unique_lock lock(connecting_, std::try_to_lock);
  if (lock.owns_lock() && board_.connected()) {
    board_.post_stop();
  }
}

void SharedBoard::request(BoardRequest request) {
  const std::lock_guard lock(mutex_);
  if (requests_.size() < kMaxRequests) {
    requests_.push_back(request);
  }
}

void SharedBoard::ask(core::wire::MessageKind kind, std::vector<std::byte> payload, Answer answer) {
  {
    const std::lock_guard lock(mutex_);
    if (questions_.size() < kMaxBoardQuestions) {
      questions_.push_back({kind, std::move(payload), std::move(answer)});
      return;
    }
  }
  answer(no_reply(kind));
}

// The board's thread

void SharedBoard::run() {
  while (running_) {
    if (snapshot_.link == Link::kHere) {
      pass();
    } else {
      wait_for_board();
    }
  }
}

void SharedBoard::pass() {
  try {
    stop_if_wanted();
    execute_requests();
    continue_arming();
    ask_question();
  } catch (const client::LinkError& error) {
    report(error.what());
  }
  board_.connection().wait_for_stream(kMaxWait);
  const std::vector<Snapshot> snapshots = take_snapshots();
  if (!snapshots.empty()) {
    publish_(snapshots);
  }
  check_link(!snapshots.empty());
}

void SharedBoard::stop_if_wanted() {
  if (!board_.connected() || !stop_wanted_.exchange(false)) {
    return;
  }
  arming_until_.reset();
  try {
    board_.stop();
  } catch (const client::LinkError&) {
    stop_wanted_ = true;
    throw;
  }
}

/// The requests behind one that is refused are executed nevertheless.
void SharedBoard::execute_requests() {
  std::deque<BoardRequest> requests;
  {
    const std::lock_guard lock(mutex_);
    requests.swap(requests_);
  }
  for (const BoardRequest request : requests) {
    try {
      execute(request);
    } catch (const client::LinkError& error) {
      report(error.what());
    }
  }
}

/// One in a pass, so that telemetry does not wait for those of many programs.
void SharedBoard::ask_question() {
  Question question;
  {
    const std::lock_guard lock(mutex_);
    if (questions_.empty()) {
      return;
    }
    question = std::move(questions_.front());
    questions_.pop_front();
  }
  question.answer(snapshot_.link == Link::kHere && board_.connected()
                      ? board_.connection().call(question.kind, question.payload)
                      : no_reply(question.kind));
}

void SharedBoard::execute(BoardRequest request) {
  if (request == BoardRequest::kConnect) {
    connect_wanted_ = snapshot_.link == Link::kTaken;
  } else if (snapshot_.link != Link::kHere) {
    report("the board is not connected");
  } else if (request == BoardRequest::kClear) {
    board_.clear_faults();
  } else if (request == BoardRequest::kHome) {
    board_.home();
  } else if (!arming_until_ && !stop_wanted_) {
    board_.begin_arming();
    arming_until_ = board_.connection().now() + kConfirmTimeout;
    next_look_ = {};
  }
}

void SharedBoard::continue_arming() {
  if (!arming_until_ || board_.connection().now() < next_look_) {
    return;
  }
  const bool is_late = board_.connection().now() > *arming_until_;
  next_look_ = board_.connection().now() + kLookInterval;
  try {
    if (board_.go_on_arming()) {
      arming_until_.reset();
    } else if (is_late) {
      arming_until_.reset();
      board_.stop();
      report(fmt::format("arm: not confirmed within 30 s ({})", board_.who_confirms()));
    }
  } catch (const client::LinkError&) {
    arming_until_.reset();
    throw;
  }
}

std::vector<Snapshot> SharedBoard::take_snapshots() {
  std::vector<Snapshot> snapshots;
  for (const client::Telemetry& telemetry : board_.take_stream()) {
    const std::uint32_t since_us = telemetry.header.board_time_us - last_time_us_;
    if (has_tick_ && (since_us == 0U || since_us > 0x80000000U)) {
      continue;  // out of order
    }
    snapshot_.time_us += has_tick_ ? since_us : 0U;
    has_tick_ = true;
    last_time_us_ = telemetry.header.board_time_us;
    snapshot_.tick = telemetry;
    snapshots.push_back(snapshot_);
  }
  if (!snapshots.empty()) {
    snapshots.back().dropped = snapshot_.dropped = board_.dropped();
  }
  return snapshots;
}

void SharedBoard::check_link(bool has_news) {
  const microseconds now = board_.connection().now();
  silence_ = has_news ? microseconds(0) : silence_ + std::min(now - last_pass_, kMaxCounted);
  last_pass_ = now;
  if (!board_.connected()) {
    set_lost(Link::kLost, "the board is disconnected or without power; it is looked for");
  } else if (!board_.in_session()) {
    set_lost(Link::kTaken,
             "another program uses the board, or the board was reset (end that program, then send "
             "{\"tactree\": {\"connect\": true}})");
  } else if (silence_ > kMaxSilence) {
    set_lost(Link::kLost, "the board sends no telemetry; it is looked for");
  }
}

void SharedBoard::set_lost(Link link, const std::string& why) {
  snapshot_.link = link;
  snapshot_.why = why;
  arming_until_.reset();
  settings_.tell(fmt::format("{}: {}", settings_.port, why));
}

void SharedBoard::wait_for_board() {
  publish_({snapshot_});
  std::this_thread::sleep_for(kRetryInterval);
  execute_requests();
  ask_question();
  if (snapshot_.link == Link::kLost || std::exchange(connect_wanted_, false)) {
    reconnect();
  }
}

void SharedBoard::reconnect() {
  try {
    {
      const std::lock_guard lock(connecting_);
      board_.reconnect();
    }
    begin_session();
    stop_wanted_ = false;  // a new session starts in the stopped state
    settings_.tell(fmt::format("{}: the board is connected again", settings_.port));
  } catch (const client::LinkError& error) {
    if (snapshot_.link == Link::kTaken) {
      report(error.what());
    } else {
      snapshot_.why = error.what();
    }
  }
}

void SharedBoard::report(const std::string& news) {
  ++snapshot_.news.number;
  snapshot_.news.text = news;
}

}  // namespace tactree::share
