#pragma once
// A WebSocket of a client: text messages in both directions.

#include <boost/beast/core/error.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "tactree/web/listener.hpp"
#include "tactree/web/types.hpp"

namespace tactree::web {

/// Used by the server's thread, which also calls the handlers. A handler that holds the owner of
/// the socket keeps it alive until it has been called. At most one call each of read(), write() and
/// ping() may be under way.
class WebSocket {
 public:
  using Done = std::function<void(boost::beast::error_code)>;
  /// The text of a message; empty after an error.
  using Received = std::function<void(boost::beast::error_code, std::string)>;

  /// `max_message_bytes`: a longer message of the client ends the connection.
  WebSocket(boost::beast::tcp_stream stream, std::size_t max_message_bytes);
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;
  ~WebSocket();

  /// Answers the request for the WebSocket.
  void accept(const Request& request, Done done);
  void read(Received received);
  void write(Message text, Done done);
  void ping(Done done);
  /// Calls heard() for each ping, pong and close of the client.
  void on_control(std::function<void()> heard);
  /// Closes the connection; the client is told to try again later.
  void refuse(Done done);
  /// Ends the connection without a closing handshake, which the client may not read.
  void cut();
  /// Address and port of the client: "127.0.0.1:40000".
  [[nodiscard]] std::string peer() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tactree::web
