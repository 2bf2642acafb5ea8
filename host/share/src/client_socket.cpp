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
  socket_.control_callback(
      [this](websocket::frame_type, beast::string_view) { silent_checks_ = 0; });
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
    refuse(fmt::format("there are {} clients already (end one)", Clients::kMaxClients));
    return;
  }
  room_.sockets.insert(this);
  room_.tell(fmt::format("{}: connected", room_.clients.name_of(number_)));
  read();
  write_next();
}

/// The client gets one message, which has the form of a state without a device.
void ClientSocket::refuse(const std::string& why) {
  writing_ = std::make_shared<const std::string>(refusal_text(why));
  socket_.async_write(asio::buffer(*writing_),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        if (!error) {
                          self->socket_.async_close(websocket::close_code::try_again_later,
                                                    [self](beast::error_code) {});
                        }
                      });
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
    self->silent_checks_ = 0;
    self->room_.clients.receive(self->number_, beast::buffers_to_string(self->incoming_.data()));
    self->incoming_.consume(self->incoming_.size());
    self->tell_command();
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

void ClientSocket::tell_command() {
  const unsigned in_command = room_.clients.in_command();
  if (in_command != std::exchange(room_.told_in_command, in_command) && in_command != 0U) {
    room_.tell(fmt::format("{}: has command", room_.clients.name_of(in_command)));
  }
}

void ClientSocket::check(Clock::time_point now) {
  if (number_ != 0U && writing_ != nullptr && now - writing_since_ > kMaxStall) {
    end(fmt::format("disconnected, because it has read nothing for {} s; {} states were dropped",
                    kMaxStall.count(), room_.clients.dropped(number_)));
  }
  ++silent_checks_;
  if (number_ != 0U && room_.clients.in_command() == number_) {
    check_answers();
  }
}

void ClientSocket::check_answers() {
  constexpr std::int64_t kMaxChecks = kMaxSilence / kCheckInterval;
  if (silent_checks_ > kMaxChecks) {
    end(fmt::format("disconnected, because it had command and has answered nothing for {} s",
                    kMaxSilence.count()));
  } else if (silent_checks_ > kMaxChecks / 2 && !pinging_) {
    pinging_ = true;
    socket_.async_ping({},
                       [self = shared_from_this()](beast::error_code) { self->pinging_ = false; });
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
