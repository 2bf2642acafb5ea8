#include "client_socket.hpp"

#include <fmt/format.h>

#include <boost/beast/websocket/error.hpp>
#include <utility>

namespace tactree::share {

namespace beast = boost::beast;

ClientSocket::ClientSocket(beast::tcp_stream stream, Room& room)
    : socket_(std::move(stream), kMaxMessageBytes), room_(room) {}

ClientSocket::~ClientSocket() {
  if (number_ != 0U) {
    room_.sockets.erase(this);
    room_.clients.leave(number_);
  }
}

void ClientSocket::accept(const web::Request& request) {
  socket_.on_control([this] { silent_checks_ = 0; });
  socket_.accept(request, [self = shared_from_this()](beast::error_code error) {
    if (!error) {
      self->begin();
    }
  });
}

void ClientSocket::begin() {
  const std::string address = socket_.peer();
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
  socket_.write(std::make_shared<const std::string>(refusal_text(why)),
                [self = shared_from_this()](beast::error_code error) {
                  if (!error) {
                    self->socket_.refuse([self](beast::error_code) {});
                  }
                });
}

void ClientSocket::read() {
  socket_.read([self = shared_from_this()](beast::error_code error, const std::string& text) {
    if (error == beast::websocket::error::closed) {
      self->end("has left");
    } else if (error == beast::websocket::error::message_too_big) {
      self->end(
          fmt::format("disconnected, because a message has more than {} bytes", kMaxMessageBytes));
    } else if (error) {
      self->end("disconnected: " + error.message());
    }
    if (self->number_ == 0U) {
      return;
    }
    self->silent_checks_ = 0;
    self->room_.clients.receive(self->number_, text);
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
  socket_.write(writing_, [self = shared_from_this()](beast::error_code error) {
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
    socket_.ping([self = shared_from_this()](beast::error_code) { self->pinging_ = false; });
  }
}

void ClientSocket::end(const std::string& how) {
  if (number_ == 0U) {
    return;
  }
  room_.tell(fmt::format("{}: {}", room_.clients.name_of(number_), how));
  room_.sockets.erase(this);
  room_.clients.leave(std::exchange(number_, 0U));
  socket_.cut();
}

}  // namespace tactree::share
