#pragma once
// A controller on this computer, at a socket in the file system: tactree-controller.

#include <memory>
#include <string>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Throws LinkError: nobody is there, no permission.
[[nodiscard]] std::unique_ptr<Transport> open_local_socket(const std::string& path);

}  // namespace tactree::client
