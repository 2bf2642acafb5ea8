#pragma once
// An HTTP server for one machine, whose clients may open WebSockets.
//
// It listens on the loopback interface by default, answers only requests for the address on which
// it listens (which defeats DNS rebinding), and refuses the pages of other servers. Number and
// memory of the connections are bounded.

#include <boost/asio/io_context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tactree/web/types.hpp"

namespace tactree::web {

using Request = boost::beast::http::request<boost::beast::http::string_body>;

/// What a server serves. Called from the server's thread, unless stated otherwise.
class Content {
 public:
  Content() = default;
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;
  virtual ~Content() = default;

  /// The content of a path without query; 404 if the path is unknown. Called from another thread
  /// if the path is slow.
  [[nodiscard]] virtual HttpResponse answer(std::string_view path) const = 0;
  [[nodiscard]] virtual bool is_slow(std::string_view path) const = 0;
  /// The path is that of a WebSocket.
  [[nodiscard]] virtual bool is_socket(std::string_view path) const = 0;
  /// Programs, which send no origin, may open a WebSocket. Otherwise only the server's own page
  /// may.
  [[nodiscard]] virtual bool admits_programs() const = 0;
  /// The request for a WebSocket has the token that the server demands, if it demands one.
  [[nodiscard]] virtual bool permits(const Request&) const { return true; }
  /// Takes over a connection that requests a WebSocket.
  virtual void open_socket(boost::beast::tcp_stream stream, const Request& request) = 0;
};

class Listener {
 public:
  /// Starts to listen. The content must outlive the listener. Throws ServerError.
  Listener(const ServerOptions& options, Content& content);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  /// "127.0.0.1:8023"
  [[nodiscard]] const std::string& host() const;
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] boost::asio::io_context& context();
  /// Serves until SIGINT, SIGTERM or stop().
  void run();
  void stop();  ///< may be called from any thread
  /// Destroys the open connections, with the objects that their handlers hold. Call it last.
  void close();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tactree::web
