#include "tactree/share/clients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactree/core/control/state_machine.hpp"

namespace tactree::share {
namespace {

bool is_zero(const std::array<float, 3>& force_N) {
  return std::all_of(force_N.begin(), force_N.end(),
                     [](float component) { return component == 0.0F; });
}

core::State state_in(const Snapshot& snapshot) {
  return static_cast<core::State>(std::min(snapshot.tick.state, core::kStates - 1U));
}

}  // namespace

unsigned Clients::join(const std::string& address) {
  if (clients_.size() >= kMaxClients) {
    return 0;
  }
  ++last_number_;
  Client client;
  client.address = address;
  clients_.emplace(last_number_, std::move(client));
  return last_number_;
}

void Clients::leave(unsigned number) {
  clients_.erase(number);
  if (is_in_command(number)) {
    end_command();
  }
  if (armed_by_ == number) {
    armed_by_ = 0;
    board_.stop();
  }
}

std::string Clients::name_of(unsigned number) const {
  return fmt::format("client {}, {}", number, clients_.at(number).address);
}

std::uint64_t Clients::dropped(unsigned number) const {
  return clients_.at(number).outbox.dropped();
}

void Clients::receive(unsigned number, const std::string& text) {
  Client& client = clients_.at(number);
  const ClientMessage message =
      read_message(text, newest_.board ? newest_.board->device_id : std::string());
  if (!message.refusal.empty()) {
    client.refusal = message.refusal;
  }
  client.may_get = true;
  if (message.subscription) {
    subscribe(client, *message.subscription);
  }
  if (message.stop) {
    has_force_ = false;
    armed_by_ = 0;
    board_.stop();
  } else {
    execute(number, message);
  }
}

void Clients::subscribe(Client& client, const SubscriptionRequest& wanted) {
  const double rate_hz = newest_.board ? static_cast<double>(newest_.board->can.rate_hz) : 0.0;
  const double every = wanted.rate_hz > 0.0 ? std::max(1.0, rate_hz / wanted.rate_hz) : 0.0;
  // One tick of 10^9 is as good as none.
  client.outbox.subscribe(static_cast<std::uint32_t>(std::lround(std::min(every, 1e9))),
                          wanted.queue);
}

void Clients::execute(unsigned number, const ClientMessage& message) {
  if (message.take_command) {
    (void)take_command(number, "take_command");
  }
  for (const BoardRequest wanted : message.requests) {
    request(number, wanted);
  }
  if (message.force_N) {
    set_force(number, *message.force_N);
  }
  if (message.release_command && is_in_command(number)) {
    end_command();
  }
}

void Clients::request(unsigned number, BoardRequest request) {
  if (request == BoardRequest::kConnect) {  // starts no motor
    board_.request(request);
    return;
  }
  const char* const what = request == BoardRequest::kClear  ? "clear"
                           : request == BoardRequest::kHome ? "home"
                                                            : "arm";
  if (!take_command(number, what)) {
    return;
  }
  if (request == BoardRequest::kArm) {
    armed_by_ = number;
  }
  board_.request(request);
}

// A client that only watches sends forces of zero, because it gets a state for each message.
void Clients::set_force(unsigned number, const std::array<float, 3>& force_N) {
  if (is_zero(force_N) && !is_in_command(number)) {
    return;
  }
  const bool acts = newest_.link == Link::kHere && state_in(newest_) == core::State::kActive;
  // Without effect, it does not take the command, so that another program can arm the board.
  if ((acts || commander_.client != 0U) && !take_command(number, "set_cursor_force")) {
    return;
  }
  if (!acts) {
    if (!is_zero(force_N)) {
      clients_.at(number).refusal =
          newest_.link != Link::kHere
              ? "set_cursor_force: the board is not connected"
              : fmt::format(
                    "set_cursor_force: the board is in state {}, without force (send "
                    "{{\"tactree\": {{\"arm\": true}}}}, or start tactree serve --arm)",
                    core::name_of(state_in(newest_)));
    }
    return;
  }
  force_N_ = force_N;
  has_force_ = true;
  if (!sent_force_) {
    send_force();
  }
}

void Clients::send_force() {
  board_.add_force(force_N_);
  has_force_ = false;
  sent_force_ = true;
}

bool Clients::take_command(unsigned number, const char* what) {
  if (commander_.client == 0U) {
    commander_ = {number, clients_.at(number).address};
    commander_since_us_ = newest_.time_us;
  }
  if (is_in_command(number)) {
    return true;
  }
  clients_.at(number).refusal = fmt::format(
      "{}: client {}, {}, has command since {} s (end it, or have it send "
      "release_command)",
      what, commander_.client, commander_.address,
      (newest_.time_us - commander_since_us_) / 1'000'000U);
  return false;
}

// The force of the client ends by itself.
void Clients::end_command() {
  commander_ = {};
  has_force_ = false;
}

void Clients::offer(const Snapshot& snapshot) {
  newest_ = snapshot;
  ++states_;
  text_ = nullptr;
  first_text_ = nullptr;
  sent_force_ = false;
  if (has_force_) {
    send_force();
  }
  const std::uint32_t tick = snapshot.tick.header.tick;
  for (auto& [number, client] : clients_) {
    const bool is_lost = snapshot.link != Link::kHere && client.outbox.every_ticks() != 0U;
    if (is_lost || client.outbox.is_due(tick)) {
      client.outbox.push(text_for(client), tick);
    }
  }
}

Message Clients::text_for(Client& client) {
  const bool first = client.knows != newest_.board;
  client.knows = newest_.board;
  Message& text = first ? first_text_ : text_;
  if (text == nullptr) {
    text = std::make_shared<const std::string>(state_text(newest_, grip_, commander_, first));
  }
  return text;
}

Message Clients::next(unsigned number) {
  Client& client = clients_.at(number);
  if (client.outbox.every_ticks() != 0U) {
    const Message state = client.outbox.pop();
    return state == nullptr ? nullptr : addressed(number, client, state);
  }
  if (!client.may_get || client.last_state == states_) {
    return nullptr;
  }
  client.may_get = false;
  client.last_state = states_;
  return addressed(number, client, text_for(client));
}

Message Clients::addressed(unsigned number, Client& client, const Message& state) const {
  const ClientFacts facts{number, is_in_command(number), client.outbox.dropped(),
                          client.outbox.every_ticks()};
  if (facts == client.told && client.refusal.empty()) {
    return state;
  }
  client.told = facts;
  return std::make_shared<const std::string>(
      with_facts(*state, facts, std::exchange(client.refusal, {})));
}

}  // namespace tactree::share
