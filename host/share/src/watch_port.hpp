#pragma once
// A Unix domain socket at which programs watch a shared board with the protocol of boards, as of a
// port unix:PATH. Used by the server's thread.

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "tactree/share/shared_board.hpp"

namespace tactree::share {

class WatchingProgram;

class WatchPort {
 public:
  static constexpr std::size_t kMaxPrograms = 32;

  /// Creates the socket, for this user only. `path` empty: in a new folder. Throws
  /// web::ServerError.
  WatchPort(boost::asio::io_context& context, SharedBoard& board, const std::string& path,
            std::function<void(const std::string&)> tell);
  WatchPort(const WatchPort&) = delete;
  WatchPort& operator=(const WatchPort&) = delete;
  /// Removes the socket.
  ~WatchPort();

  /// "unix:/tmp/tactree-x1y2z3/board"
  [[nodiscard]] std::string port() const { return "unix:" + path_; }
  /// A tick for all programs. If the board is lost, they are disconnected.
  void offer(const Snapshot& snapshot);
  /// Sends what has been offered.
  void write();
  /// Ends listening. Call it before the context is destroyed.
  void close() { acceptor_.reset(); }

 private:
  friend class WatchingProgram;

  void listen(boost::asio::io_context& context);
  void bind(boost::asio::io_context& context);
  void accept();
  void welcome(boost::asio::local::stream_protocol::socket socket);

  SharedBoard& board_;
  std::function<void(const std::string&)> tell_;
  std::string path_;
  std::string folder_;  // created for the socket; empty: none
  std::optional<boost::asio::local::stream_protocol::acceptor> acceptor_;
  std::set<WatchingProgram*> programs_;
  unsigned last_number_ = 0;
};

}  // namespace tactree::share
