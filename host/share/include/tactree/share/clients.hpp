#pragma once
// The clients of a shared board, without their sockets: who is in command, what each may do, and
// which message each gets next. All clients watch; one is in command. No clock and no thread: times
// are those of the board.

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "tactree/share/messages.hpp"
#include "tactree/share/outbox.hpp"
#include "tactree/share/snapshot.hpp"

namespace tactree::share {

/// What clients do to a board. No function waits for the board.
class BoardCommands {
 public:
  BoardCommands() = default;
  BoardCommands(const BoardCommands&) = delete;
  BoardCommands& operator=(const BoardCommands&) = delete;
  virtual ~BoardCommands() = default;

  /// For the maximum duration of an added force, see core::kAddedForceSeconds.
  virtual void add_force(const std::array<float, 3>& force_N) = 0;
  virtual void stop() = 0;
  virtual void request(BoardRequest request) = 0;
};

class Clients {
 public:
  static constexpr std::size_t kMaxClients = 32;

  /// The board must outlive the clients.
  Clients(BoardCommands& board, Grip grip) : board_(board), grip_(grip) {}

  /// Adds a client and returns its number, from 1; 0 if there are too many. `address` is for
  /// messages: "127.0.0.1:51234".
  [[nodiscard]] unsigned join(const std::string& address);
  /// Its command ends. A board that it has armed stops.
  void leave(unsigned number);
  /// A message of a client.
  void receive(unsigned number, const std::string& text);
  /// A new state of the board.
  void offer(const Snapshot& snapshot);
  /// The next message to this client; nullptr if there is none yet. A client that has not
  /// subscribed gets one state when it joins and one for each of its messages, always the newest.
  [[nodiscard]] Message next(unsigned number);

  /// The client in command; 0: nobody.
  [[nodiscard]] unsigned in_command() const { return commander_.client; }
  [[nodiscard]] std::uint64_t dropped(unsigned number) const;
  /// "client 2, 127.0.0.1:51234"
  [[nodiscard]] std::string name_of(unsigned number) const;

 private:
  struct Client {
    std::string address;
    Outbox outbox{};
    bool may_get = true;           // it has sent a message since its last state
    std::uint64_t last_state = 0;  // number of that state
    std::string refusal{};         // not told yet
    ClientFacts told{};
    std::shared_ptr<const Description> knows{};  // the description that it has got
  };

  void subscribe(Client& client, const SubscriptionRequest& wanted);
  void execute(unsigned number, const ClientMessage& message);
  void request(unsigned number, BoardRequest request);
  void set_force(unsigned number, const std::array<float, 3>& force_N);
  void send_force();
  [[nodiscard]] bool is_in_command(unsigned number) const { return commander_.client == number; }
  /// Returns false if another client is in command; it is then the refusal of `what`.
  [[nodiscard]] bool take_command(unsigned number, const char* what);
  void end_command();
  [[nodiscard]] Message text_for(Client& client);
  [[nodiscard]] Message addressed(unsigned number, Client& client, const Message& state) const;

  BoardCommands& board_;
  Grip grip_;
  std::map<unsigned, Client> clients_;
  unsigned last_number_ = 0;
  Commander commander_{};
  std::uint64_t commander_since_us_ = 0;
  unsigned armed_by_ = 0;

  // At most one force for each state of the board: a faster client must not fill its port.
  bool has_force_ = false;
  bool sent_force_ = false;
  std::array<float, 3> force_N_{};

  Snapshot newest_{};
  std::uint64_t states_ = 0;  // offered so far
  Message text_;              // of the newest state; nullptr: not yet written
  Message first_text_;        // with the description of the board
};

}  // namespace tactree::share
