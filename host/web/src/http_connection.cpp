#include "http_connection.hpp"

#include <boost/asio/dispatch.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <utility>

namespace tactree::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using Response = http::response<http::string_body>;

constexpr std::uint32_t kMaxRequestHeaderBytes = 8192;
constexpr std::uint64_t kMaxRequestBodyBytes = 0;  // the page sends no bodies
constexpr std::chrono::seconds kMaxTransferTime(30);

// Scripts, styles, pictures and connections from this server only; no embedding in other pages.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: "
    "blob:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

std::string text_of(beast::string_view text) { return {text.data(), text.size()}; }

HttpResponse plain(unsigned status, std::string text) {
  return {status, "text/plain; charset=utf-8", std::move(text), {}};
}

}  // namespace

HttpConnection::HttpConnection(asio::ip::tcp::socket socket, Service& service)
    : stream_(std::move(socket)), service_(service) {
  ++service_.connections;
}

HttpConnection::~HttpConnection() { --service_.connections; }

void HttpConnection::read() {
  parser_.emplace();
  parser_->header_limit(kMaxRequestHeaderBytes);
  parser_->body_limit(kMaxRequestBodyBytes);
  stream_.expires_after(kMaxTransferTime);
  http::async_read(
      stream_, buffer_, *parser_,
      [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (!error) {
          self->handle(self->parser_->release());
          return;
        }
        const bool ours =
            error.category() == http::make_error_code(http::error::bad_method).category();
        if (ours && error != http::error::end_of_stream && error != http::error::partial_message) {
          Request request;  // could not be read; the connection is closed after the answer
          request.version(11);
          request.keep_alive(false);
          self->send(plain(400, "invalid request: " + error.message() + "\n"), request);
        }
      });
}

bool HttpConnection::is_ours(beast::string_view host) const {
  if (!service_.any_host.empty() && host.ends_with(service_.any_host)) {
    // The addresses of the machine are unknown here. Accepts any address, but no name.
    host.remove_suffix(service_.any_host.size());
    if (host.starts_with('[') && host.ends_with(']')) {
      host = host.substr(1, host.size() - 2);
    }
    boost::system::error_code error;
    asio::ip::make_address(text_of(host), error);
    return !error;
  }
  return host == service_.host || (!service_.local_host.empty() && host == service_.local_host);
}

std::optional<HttpResponse> HttpConnection::refusal(const Request& request) const {
  if (!is_ours(request[http::field::host])) {
    return plain(421, "this server is http://" + service_.host + "/\n");
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    return plain(405, "only GET and HEAD\n");
  }
  if (request.target().empty() || request.target().front() != '/') {
    return plain(400, "a path starts with /\n");
  }
  // Pages of other sites have another origin. Programs send no origin. They may read; a WebSocket,
  // however, can move the device, and the content decides whether programs may open one.
  const beast::string_view origin = request[http::field::origin];
  const bool from_here =
      origin.starts_with("http://") && origin.substr(7) == request[http::field::host];
  const bool admitted =
      origin.empty() ? service_.content.admits_programs() || !beast::websocket::is_upgrade(request)
                     : from_here;
  if (!admitted) {
    return plain(403, "not from http://" + service_.host + "\n");
  }
  return std::nullopt;
}

void HttpConnection::handle(const Request& request) {
  if (auto refused = refusal(request)) {
    send(std::move(*refused), request);
    return;
  }
  const beast::string_view target = request.target();
  const std::string path = text_of(target.substr(0, target.find('?')));
  if (service_.content.is_socket(path)) {
    if (!beast::websocket::is_upgrade(request)) {
      send(plain(426, "this is a WebSocket\n"), request);
      return;
    }
    if (!service_.content.permits(request)) {
      send(plain(401, "a token is needed, as in ws://" + service_.host + path + "?token=TOKEN\n"),
           request);
      return;
    }
    service_.content.open_socket(std::move(stream_), request);
    return;
  }
  look_up(path, request);
}

void HttpConnection::look_up(std::string path, const Request& request) {
  if (!service_.content.is_slow(path)) {
    send(service_.content.answer(path), request);
    return;
  }
  const auto kept = std::make_shared<const Request>(request);
  asio::post(service_.worker, [self = shared_from_this(), path = std::move(path), kept] {
    const auto answer = std::make_shared<HttpResponse>(self->service_.content.answer(path));
    asio::dispatch(self->stream_.get_executor(),
                   [self, answer, kept] { self->send(std::move(*answer), *kept); });
  });
}

void HttpConnection::send(HttpResponse answer, const Request& request) {
  auto response =
      std::make_shared<Response>(static_cast<http::status>(answer.status), request.version());
  response->set(http::field::content_type, answer.type);
  response->set(http::field::cache_control, "no-store");
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Content-Security-Policy", kPolicy);
  response->set("Cross-Origin-Resource-Policy", "same-origin");
  if (!answer.file_name.empty()) {
    response->set(http::field::content_disposition,
                  "attachment; filename=\"" + answer.file_name + "\"");
  }
  response->keep_alive(request.keep_alive() && answer.status < 400);
  const std::size_t size = answer.body.size();
  if (request.method() != http::verb::head) {
    response->body() = std::move(answer.body);
  }
  response->content_length(size);
  stream_.expires_after(kMaxTransferTime);
  http::async_write(stream_, *response,
                    [self = shared_from_this(), response](beast::error_code error, std::size_t) {
                      if (!error && response->keep_alive()) {
                        self->read();
                        return;
                      }
                      beast::error_code ignored;
                      self->stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send,
                                                      ignored);
                    });
}

}  // namespace tactree::web
