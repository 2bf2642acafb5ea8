#pragma once
// A client's WebSocket: moves messages between it and the clients of the board.

#include <boost/beast/core/tcp_stream.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "tactree/share/clients.hpp"
#include "tactree/web/web_socket.hpp"

namespace tactree::share {

class ClientSocket;

/// Shared by the sockets of a server, and used by its thread.
struct Room {
  Clients clients;
  std::function<void(const std::string&)> tell;
  std::set<ClientSocket*> sockets{};
  unsigned told_in_command = 0;  // the client that the terminal names; 0: nobody
};

class ClientSocket : public std::enable_shared_from_this<ClientSocket> {
 public:
  using Clock = std::chrono::steady_clock;

  /// Maximum size of a message of a client, bytes.
  static constexpr std::size_t kMaxMessageBytes = 16384;
  /// A client that takes no byte for this time is disconnected.
  static constexpr std::chrono::seconds kMaxStall{5};
  /// A client in command that answers nothing, not even a ping, for this time is disconnected.
  static constexpr std::chrono::seconds kMaxSilence{10};
  /// Of check().
  static constexpr std::chrono::seconds kCheckInterval{1};

  ClientSocket(boost::beast::tcp_stream stream, Room& room);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  /// Accepts a request for a WebSocket. The object then keeps itself alive until the client leaves.
  void accept(const web::Request& request);
  /// Sends the next message, if there is one and none is being sent.
  void write_next();
  /// Disconnects a client that does not take its message, or that is in command and does not
  /// answer. Call it every kCheckInterval.
  void check(Clock::time_point now);

 private:
  void begin();
  void refuse(const std::string& why);
  void read();
  void tell_command();
  void check_answers();
  /// `how`: for the terminal.
  void end(const std::string& how);

  web::WebSocket socket_;
  Room& room_;
  Message writing_;  // being sent
  Clock::time_point writing_since_{};
  // Checks since the client was heard: as many as pass, also if this program stood still meanwhile.
  std::int64_t silent_checks_ = 0;
  bool pinging_ = false;
  unsigned number_ = 0;  // 0: not a client, or no longer
};

}  // namespace tactree::share
