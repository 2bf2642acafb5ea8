#pragma once
// A client's WebSocket: moves messages between it and the clients of the board.

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "tactree/share/clients.hpp"
#include "tactree/web/listener.hpp"

namespace tactree::share {

class ClientSocket;

/// Shared by the sockets of a server, and used by its thread.
struct Room {
  Clients clients;
  std::function<void(const std::string&)> tell;
  std::set<ClientSocket*> sockets{};
};

class ClientSocket : public std::enable_shared_from_this<ClientSocket> {
 public:
  using Clock = std::chrono::steady_clock;

  /// Maximum size of a message of a client, bytes.
  static constexpr std::size_t kMaxMessageBytes = 16384;
  /// A client that takes no byte for this time is disconnected.
  static constexpr std::chrono::seconds kMaxStall{5};

  ClientSocket(boost::beast::tcp_stream stream, Room& room);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  /// Accepts a request for a WebSocket. The object then keeps itself alive until the client leaves.
  void accept(const web::Request& request);
  /// Sends the next message, if there is one and none is being sent.
  void write_next();
  /// Disconnects a client that has not taken its message for kMaxStall.
  void check_stall(Clock::time_point now);

 private:
  void begin();
  void read();
  /// `how`: for the terminal.
  void end(const std::string& how);

  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  Room& room_;
  boost::beast::flat_buffer incoming_;
  Message writing_;  // being sent
  Clock::time_point writing_since_{};
  unsigned number_ = 0;  // 0: not a client, or no longer
};

}  // namespace tactree::share
