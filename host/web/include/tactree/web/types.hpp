#pragma once
// Options, errors, answers and messages of a server.

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace tactree::web {

/// Text of a message, which several clients may share.
using Message = std::shared_ptr<const std::string>;

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;                   ///< 0: any free port
  const char* port_option = "--page-port";  ///< on the command line, for messages
};

/// The address is invalid or in use.
class ServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct HttpResponse {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
  std::string file_name;  ///< if not empty, the body is downloaded under this name
};

}  // namespace tactree::web
