#include "watch_port.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>
#include <vector>

#include "tactree/share/watcher.hpp"
#include "tactree/web/types.hpp"

namespace tactree::share {
namespace {

namespace asio = boost::asio;
using Local = asio::local::stream_protocol;

constexpr std::size_t kReadBytes = 4096;

std::string new_folder() {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  std::string folder = (parent / "tactree-XXXXXX").string();
  if (error || ::mkdtemp(folder.data()) == nullptr) {
    throw web::ServerError(fmt::format("{}: {} (set TMPDIR to a folder that is writable)", folder,
                                       error ? error.message() : std::strerror(errno)));
  }
  return folder;
}

/// A program that was killed has left its socket.
bool is_abandoned(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_socket(path, error)) {
    return false;
  }
  asio::io_context context;
  Local::socket probe(context);
  boost::system::error_code refused;
  probe.connect(Local::endpoint(path), refused);
  return refused == asio::error::connection_refused;
}

}  // namespace

/// The connection of a program. Its handlers keep it alive.
class WatchingProgram : public std::enable_shared_from_this<WatchingProgram> {
 public:
  WatchingProgram(Local::socket socket, WatchPort& port, unsigned number)
      : socket_(std::move(socket)), port_(&port), number_(number) {
    port.programs_.insert(this);
    tell("connected");
  }
  ~WatchingProgram() {
    if (port_ != nullptr) {
      port_->programs_.erase(this);
    }
  }
  WatchingProgram(const WatchingProgram&) = delete;
  WatchingProgram& operator=(const WatchingProgram&) = delete;

  void offer(const Snapshot& snapshot) { watcher_.offer(snapshot); }

  /// Reads unless the program does not take what it is sent.
  void read() {
    if (reading_ || port_ == nullptr || watcher_.is_full()) {
      return;
    }
    reading_ = true;
    socket_.async_read_some(
        asio::buffer(incoming_),
        [self = shared_from_this()](boost::system::error_code error, std::size_t bytes) {
          self->reading_ = false;
          if (error) {
            return self->end("has left");
          }
          if (self->port_ == nullptr) {
            return;  // ended meanwhile
          }
          self->watcher_.receive(std::span(self->incoming_).first(bytes));
          self->pass_on();
          self->write();
          self->read();
        });
  }

  void write() {
    if (writing_ || port_ == nullptr || watcher_.to_send().empty()) {
      return;
    }
    writing_ = true;
    const auto bytes = watcher_.to_send();
    outgoing_.assign(bytes.begin(), bytes.end());
    watcher_.sent(bytes.size());
    asio::async_write(socket_, asio::buffer(outgoing_),
                      [self = shared_from_this()](boost::system::error_code error, std::size_t) {
                        self->writing_ = false;
                        if (error) {
                          return self->end("has left");
                        }
                        self->write();
                        self->read();
                      });
  }

  void end(const std::string& how) {
    if (port_ == nullptr) {
      return;
    }
    tell(how);
    port_->programs_.erase(this);
    port_ = nullptr;
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

 private:
  void tell(const std::string& what) {
    port_->tell_(fmt::format("watching program {}: {}", number_, what));
  }

  /// To the board, whose thread answers.
  void pass_on() {
    if (watcher_.take_stop()) {
      port_->board_.stop();
    }
    for (Watcher::Question& question : watcher_.take_questions()) {
      const core::wire::MessageKind kind = question.kind;
      std::vector<std::byte> payload = question.payload;
      port_->board_.ask(kind, std::move(payload),
                        [self = weak_from_this(), executor = socket_.get_executor(),
                         question](const client::Response& response) {
                          asio::post(executor, [self, question, response] {
                            if (const auto program = self.lock()) {
                              program->take(question, response);
                            }
                          });
                        });
    }
  }

  void take(const Watcher::Question& question, const client::Response& response) {
    watcher_.answer(question, response);
    write();
  }

  Local::socket socket_;
  WatchPort* port_;  // nullptr: has ended
  unsigned number_;
  Watcher watcher_;
  std::array<std::byte, kReadBytes> incoming_{};
  std::vector<std::byte> outgoing_;  // being sent
  bool reading_ = false;
  bool writing_ = false;
};

WatchPort::WatchPort(asio::io_context& context, SharedBoard& board, const std::string& path,
                     std::function<void(const std::string&)> tell)
    : board_(board), tell_(std::move(tell)), path_(path) {
  if (path.empty()) {
    folder_ = new_folder();
    path_ = folder_ + "/board";
  }
  try {
    listen(context);
  } catch (const boost::system::system_error& error) {
    std::error_code ignored;
    if (!folder_.empty()) {
      std::filesystem::remove_all(folder_, ignored);
    }
    throw web::ServerError(
        fmt::format("{}: {} (choose another --watch-socket)", path_, error.code().message()));
  }
  accept();
}

void WatchPort::listen(asio::io_context& context) {
  if (is_abandoned(path_)) {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  bind(context);
}

/// Only this user may connect, from the beginning.
void WatchPort::bind(asio::io_context& context) {
  const mode_t others = ::umask(0177);
  try {
    acceptor_.emplace(context, Local::endpoint(path_));
  } catch (...) {
    ::umask(others);
    throw;
  }
  ::umask(others);
}

WatchPort::~WatchPort() {
  acceptor_.reset();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  if (!folder_.empty()) {
    std::filesystem::remove(folder_, ignored);
  }
}

void WatchPort::accept() {
  acceptor_->async_accept([this](boost::system::error_code error, Local::socket socket) {
    if (error == asio::error::operation_aborted || !acceptor_) {
      return;
    }
    if (!error) {
      welcome(std::move(socket));
    } else if (error != asio::error::connection_aborted) {
      tell_(fmt::format("{}: {} (start tactree serve again to let programs watch)", path_,
                        error.message()));
      return;
    }
    accept();
  });
}

void WatchPort::welcome(Local::socket socket) {
  if (programs_.size() == kMaxPrograms) {
    tell_(fmt::format("a watching program was refused, because there are {} (end one)",
                      kMaxPrograms));
    return;
  }
  std::make_shared<WatchingProgram>(std::move(socket), *this, ++last_number_)->read();
}

void WatchPort::offer(const Snapshot& snapshot) {
  const std::vector<WatchingProgram*> programs(programs_.begin(), programs_.end());
  for (WatchingProgram* const program : programs) {
    if (snapshot.link == Link::kHere) {
      program->offer(snapshot);
    } else {
      program->end("disconnected, because the board is");  // its handlers keep it alive
    }
  }
}

void WatchPort::write() {
  for (WatchingProgram* const program : programs_) {
    program->write();  // sends later
  }
}

}  // namespace tactree::share
