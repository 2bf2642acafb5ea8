#pragma once
// The server of the page: HTTP for static data, a WebSocket (/live) for frames and commands.
//
// Made for one machine: it listens on the loopback interface by default, answers only requests for
// the address on which it listens (which defeats DNS rebinding), and accepts WebSockets only from
// its own page. Memory per client is bounded. A page that does not read loses frames, which are
// counted; it never delays the source.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "tactree/viewer/site.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free port
};

/// The address is invalid or in use.
class ServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Server {
 public:
  /// Starts to listen. Site and source must outlive the server. Throws ServerError.
  Server(const ServerOptions& options, const Site& site, Source& source);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// "http://127.0.0.1:8023/"
  [[nodiscard]] const std::string& address() const;
  [[nodiscard]] std::uint16_t port() const;
  /// Starts the source and serves until SIGINT, SIGTERM or stop().
  void run();
  void stop();  ///< may be called from any thread

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tactree::viewer
