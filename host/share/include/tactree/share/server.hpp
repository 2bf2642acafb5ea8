#pragma once
// The server of a shared board: a WebSocket at the path /, and a socket at which programs watch
// with the protocol of boards; docs/SHARE.md. A client that does not read delays neither the board
// nor other clients.

#include <functional>
#include <memory>
#include <string>

#include "tactree/share/messages.hpp"
#include "tactree/share/shared_board.hpp"
#include "tactree/web/types.hpp"

namespace tactree::share {

struct ServerSettings {
  web::ServerOptions server{};
  /// Programs must send it: "?token=..." or "Authorization: Bearer ..."; empty: none is needed.
  std::string token{};
  std::string watch_socket{};  ///< path; empty: in a new folder
  Grip grip = Grip::kNeutral;
  /// Prints a line on the terminal; must not throw.
  std::function<void(const std::string&)> tell;
};

class Server {
 public:
  /// Starts to listen. The board must outlive the server. Throws web::ServerError.
  Server(const ServerSettings& settings, SharedBoard& board);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// "ws://127.0.0.1:10001/", with the token if there is one
  [[nodiscard]] std::string address() const;
  /// "unix:/tmp/tactree-x1y2z3/board", for programs that watch.
  [[nodiscard]] std::string watch_port() const;
  /// Starts the board's thread and serves until SIGINT or SIGTERM.
  void run();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tactree::share
