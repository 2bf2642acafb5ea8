#pragma once
// The server of the page: HTTP for static data, a WebSocket (/live) for frames and commands.
//
// The listener (tactree/web/listener.hpp) refuses foreign requests. WebSockets are accepted only
// from the server's own page. A page that does not read loses frames, which are counted; it never
// delays the source.

#include <cstdint>
#include <memory>
#include <string>

#include "tactree/viewer/site.hpp"
#include "tactree/viewer/source.hpp"
#include "tactree/web/types.hpp"

namespace tactree::viewer {

using web::ServerError;
using web::ServerOptions;

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
