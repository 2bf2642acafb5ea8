#include "live_connection.hpp"

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace tactree::viewer {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

// Limits the unread frames in the kernel's buffer to less than one second.
constexpr int kSendBufferBytes = 64 * 1024;

websocket::stream_base::timeout timeouts() {
  websocket::stream_base::timeout t{};
  t.handshake_timeout = std::chrono::seconds(10);
  t.idle_timeout = std::chrono::seconds(60);  // the page vanished or does not read
  t.keep_alive_pings = true;
  return t;
}

}  // namespace

LiveConnection::LiveConnection(beast::tcp_stream stream, Hub& hub, Source& source)
    : socket_(std::move(stream)), hub_(hub), source_(source) {}

LiveConnection::~LiveConnection() { hub_.leave(this); }

void LiveConnection::accept(const Request& request) {
  beast::error_code ignored;
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own timeouts
  beast::get_lowest_layer(socket_).socket().set_option(
      asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  beast::get_lowest_layer(socket_).socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(timeouts());
  socket_.read_message_max(kMaxCommandBytes);
  socket_.text(true);
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) {
      return;
    }
    if (!self->hub_.join(self.get())) {
      self->close();
      return;
    }
    self->open_ = true;
    self->answer(self->source_.hello());
    self->read();
  });
}

void LiveConnection::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](beast::error_code error, std::size_t) {
    if (error) {  // also for messages that are too long; Beast has sent the cause
      self->open_ = false;
      self->hub_.leave(self.get());
      return;
    }
    self->execute(beast::buffers_to_string(self->incoming_.data()));
    self->incoming_.consume(self->incoming_.size());
    self->read();
  });
}

void LiveConnection::execute(const std::string& text) {
  const nlohmann::json command = nlohmann::json::parse(text, nullptr, false);
  const std::optional<std::string> why =
      command.is_object() ? source_.command(command) : "a command must be a JSON object";
  if (why) {
    answer(nlohmann::json({{"type", "refused"}, {"why", *why}})
               .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  }
}

void LiveConnection::answer(std::string text) {
  if (answers_.size() >= kMaxAnswers) {
    close();
    return;
  }
  answers_.push_back(std::make_shared<const std::string>(std::move(text)));
  write_next();
}

void LiveConnection::show(const Message& frame) {
  if (!open_) {
    return;
  }
  if (frame_ != nullptr) {
    hub_.count_dropped();
  }
  frame_ = frame;
  write_next();
}

void LiveConnection::write_next() {
  if (writing_ != nullptr || !open_ || (answers_.empty() && frame_ == nullptr)) {
    return;
  }
  if (!answers_.empty()) {
    writing_ = std::move(answers_.front());
    answers_.pop_front();
  } else {
    writing_ = std::exchange(frame_, nullptr);
    hub_.count_sent();
  }
  socket_.async_write(asio::buffer(*writing_),
                      [self = shared_from_this()](beast::error_code error, std::size_t) {
                        self->writing_ = nullptr;
                        if (error) {
                          self->open_ = false;
                          self->hub_.leave(self.get());
                          return;
                        }
                        self->write_next();
                      });
}

void LiveConnection::close() {
  open_ = false;
  hub_.leave(this);
  // No closing handshake, because the page may not read it.
  beast::error_code ignored;
  beast::get_lowest_layer(socket_).socket().close(ignored);
}

}  // namespace tactree::viewer
