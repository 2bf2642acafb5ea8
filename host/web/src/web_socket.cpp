#include "tactree/web/web_socket.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <utility>

namespace tactree::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

// Limits the unread messages in the kernel's buffer to a fraction of a second.
constexpr int kSendBufferBytes = 64 * 1024;

websocket::stream_base::timeout timeouts() {
  websocket::stream_base::timeout t{};
  t.handshake_timeout = std::chrono::seconds(10);
  t.idle_timeout = std::chrono::seconds(60);  // the client vanished or does not read
  t.keep_alive_pings = true;
  return t;
}

}  // namespace

struct WebSocket::Parts {
  websocket::stream<beast::tcp_stream> stream;
  beast::flat_buffer incoming{};

  asio::ip::tcp::socket& socket() { return beast::get_lowest_layer(stream).socket(); }
};

WebSocket::WebSocket(beast::tcp_stream stream, std::size_t max_message_bytes)
    : parts_(new Parts{websocket::stream<beast::tcp_stream>(std::move(stream))}) {
  beast::error_code ignored;
  beast::get_lowest_layer(parts_->stream).expires_never();  // the WebSocket has its own timeouts
  parts_->socket().set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  parts_->socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  parts_->stream.set_option(timeouts());
  parts_->stream.read_message_max(max_message_bytes);
  parts_->stream.text(true);
}

WebSocket::~WebSocket() = default;

void WebSocket::accept(const Request& request, Done done) {
  parts_->stream.async_accept(request, std::move(done));
}

void WebSocket::read(Received received) {
  parts_->stream.async_read(parts_->incoming, [this, received = std::move(received)](
                                                  beast::error_code error, std::size_t) {
    std::string text;
    if (!error) {
      text = beast::buffers_to_string(parts_->incoming.data());
      parts_->incoming.consume(parts_->incoming.size());
    }
    received(error, std::move(text));
  });
}

void WebSocket::write(Message text, Done done) {
  const asio::const_buffer bytes = asio::buffer(*text);
  parts_->stream.async_write(bytes, [text = std::move(text), done = std::move(done)](
                                        beast::error_code error, std::size_t) { done(error); });
}

void WebSocket::ping(Done done) { parts_->stream.async_ping({}, std::move(done)); }

void WebSocket::on_control(std::function<void()> heard) {
  parts_->stream.control_callback(
      [heard = std::move(heard)](websocket::frame_type, beast::string_view) { heard(); });
}

void WebSocket::refuse(Done done) {
  parts_->stream.async_close(websocket::close_code::try_again_later, std::move(done));
}

void WebSocket::cut() {
  beast::error_code ignored;
  parts_->socket().close(ignored);
}

std::string WebSocket::peer() const {
  beast::error_code error;
  const asio::ip::tcp::endpoint remote = parts_->socket().remote_endpoint(error);
  if (error) {
    return "unknown address";
  }
  const std::string address = remote.address().to_string();
  return (remote.address().is_v6() ? "[" + address + "]" : address) + ":" +
         std::to_string(remote.port());
}

}  // namespace tactree::web
