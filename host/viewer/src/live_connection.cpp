#include "live_connection.hpp"

#include <nlohmann/json.hpp>
#include <utility>

namespace tactree::viewer {

namespace beast = boost::beast;

LiveConnection::LiveConnection(beast::tcp_stream stream, Hub& hub, Source& source)
    : socket_(std::move(stream), kMaxCommandBytes), hub_(hub), source_(source) {}

LiveConnection::~LiveConnection() { hub_.leave(this); }

void LiveConnection::accept(const web::Request& request) {
  socket_.accept(request, [self = shared_from_this()](beast::error_code error) {
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
  socket_.read([self = shared_from_this()](beast::error_code error, const std::string& text) {
    if (error) {  // also for messages that are too long; Beast has sent the cause
      self->open_ = false;
      self->hub_.leave(self.get());
      return;
    }
    self->execute(text);
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
  socket_.write(writing_, [self = shared_from_this()](beast::error_code error) {
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
  socket_.cut();
}

}  // namespace tactree::viewer
