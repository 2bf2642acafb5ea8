#include "client_socket.hpp"

#include <fmt/format.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <utility>

namespace tactree::share {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

// Limits the unread states in the kernel's buffer to a fraction of a second at 1 kHz.
constexpr int kSendBufferBytes = 64 * 1024;

websocket::stream_base::timeout socket_timeouts() {
  websocket::stream_base::timeout t{};
  t.handshake_timeout = std::chrono::seconds(10);
  t.idle_timeout = std::chrono::seconds(60);  // the client vanished
  t.keep_alive_pings = true;
  return t;
}

std::string address_of(const asio::ip::tcp::socket& socket) {
  beast::error_code error;
  const asio::ip::tcp::endpoint remote = socket.remote_endpoint(error);
  if (error) {
    return "unknown address";
  }
  const std::string address = remote.address().to_string();
  return fmt::format("{}:{}", remote.address().is_v6() ? "[" + address + "]" : address,
                     remote.port());
}

}  // namespace

ClientSocket::ClientSocket(beast::tcp_stream stream, Room& room)
    : socket_(std::move(stream)), room_(room) {}

ClientSocket::~ClientSocket() {
  if (number_ != 0U) {
    room_.sockets.erase(this);
    room_.clients.leave(number_);
  }
}

void ClientSocket::accept(const web::Request& request) {
  beast::error_code ignored;
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timeouts
  beast::get_lowest_layer(socket_).socket().set_option(
      asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(socket_timeouts());
  socket_.read_message_max(kMaxMessageBytes);
  socket_.text(true);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (!error) {
      self->begin();
    }
  });
}

void ClientSocket::begin() {
  const std::string address = address_of(beast::get_lowest_layer(socket_).socket());
  number_ = room_.clients.join(address);
  if (number_ == 0U) {
    room_.tell(fmt::format("{}: refused, because there are {} clients (end one)", address,
                           Clients::kMaxClients));
    beast::error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    return;
  }
  room_.sockets.insert(this);
  room_.tell(fmt::format("{}: connected", room_.clients.name_of(number_)));
  read();
  write_next();
}

void ClientSocket::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error == websocket::error::closed) {
      self->end("has left");
    } else if (error == websocket::error::message_too_big) {
      self->end(
          fmt::format("disconnected, because a message has more than {} bytes", kMaxMessageBytes));
    } else if (error) {
      self->end("disconnected: " + error.message());
    }
    if (self->number_ == 0U) {
      return;
    }
    self->room_.clients.receive(self->number_, beast::buffers_to_string(self->incoming_.data()));
    self->incoming_.consume(self->incoming_.size());
    self->write_next();
    self->read();
  });
}

void ClientSocket::write_next() {
  if (writing_ != nullptr || number_ == 0U) {
    return;
  }
  writing_ = room_.clients.next(number_);
  if (writing_ == nullptr) {
    return;
  }
  writing_since_ = Clock::now();
  socket_.async_write(asio::buffer(*writing_),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->writing_ = nullptr;
                        if (error) {
                          self->end("disconnected: " + error.message());
                          return;
                        }
                        self->write_next();
                      });
}

void ClientSocket::check_stall(Clock::time_point now) {
  if (number_ != 0U && writing_ != nullptr && now - writing_since_ > kMaxStall) {
    end(fmt::format("disconnected, because it has read nothing for {} s; {} states were dropped",
                    kMaxStall.count(), room_.clients.dropped(number_)));
  }
}

void ClientSocket::end(const std::string& how) {
  if (number_ == 0U) {
    return;
  }
  room_.tell(fmt::format("{}: {}", room_.clients.name_of(number_), how));
  room_.sockets.erase(this);
  room_.clients.leave(std::exchange(number_, 0U));
  // No closing handshake, because the client may not read it.
  beast::error_code ignored;
  beast::get_lowest_layer(socket_).socket().close(ignored);
}

}  // namespace tactree::share
