#pragma once
// The page's server: HTTP for what does not move, a WebSocket (/live) for what does.
//
// It is made for one machine: it listens on the loopback interface unless told, answers only
// requests that name the address it listens on (so no other site's page can reach it through a
// name of its own), and takes WebSockets only from its own page. Everything a client can make
// grow is bounded. A page that does not read loses frames, counted; it never holds up the source.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "tactree/viewer/site.hpp"
#include "tactree/viewer/source.hpp"

namespace tactree::viewer {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free one
};

/// The address cannot be listened on.
class ServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Server {
 public:
  /// Listens from now on. Site and source must outlive the server. Throws ServerError.
  Server(const ServerOptions& options, const Site& site, Source& source);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// "http://127.0.0.1:8023/"
  [[nodiscard]] const std::string& address() const;
  /// Starts the source, serves until SIGINT, SIGTERM or stop().
  void run();
  void stop();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace tactree::viewer
