#pragma once
// Answers a client's HTTP requests in order; a request for a WebSocket goes to the content.

#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <memory>
#include <optional>
#include <string>

#include "tactree/web/listener.hpp"

namespace tactree::web {

/// Data shared by the connections of a server.
struct Service {
  static constexpr int kMaxConnections = 64;

  Content& content;
  boost::asio::thread_pool& worker;  // for slow answers
  std::string host;                  // "127.0.0.1:8023"
  std::string local_host;            // "localhost:8023" if listening on loopback, else empty
  std::string any_host;              // ":8023" if listening on all addresses, else empty
  int connections = 0;
};

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
 public:
  HttpConnection(boost::asio::ip::tcp::socket socket, Service& service);
  ~HttpConnection();
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  void read();

 private:
  void handle(const Request& request);
  [[nodiscard]] std::optional<HttpResponse> refusal(const Request& request) const;
  [[nodiscard]] bool is_ours(boost::beast::string_view host) const;
  void look_up(std::string path, const Request& request);
  void send(HttpResponse answer, const Request& request);

  boost::beast::tcp_stream stream_;
  Service& service_;
  boost::beast::flat_buffer buffer_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::string_body>> parser_;
};

}  // namespace tactree::web
