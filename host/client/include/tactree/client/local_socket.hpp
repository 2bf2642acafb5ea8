#pragma once
// Connection to a controller on this computer, tactree-controller, or to a board that tactree serve
// shares, over a Unix domain socket.

#include <memory>
#include <string>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Throws LinkError if no controller listens or permission is missing.
[[nodiscard]] std::unique_ptr<Transport> open_local_socket(const std::string& path);

}  // namespace tactree::client
