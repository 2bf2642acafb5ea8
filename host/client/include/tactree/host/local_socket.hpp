#pragma once
// A controller on this computer, at a socket in the file system: tactree-controller.

#include <memory>
#include <string>

#include "tactree/host/transport.hpp"

namespace tactree::host {

/// Throws LinkError: nobody is there, no permission.
[[nodiscard]] std::unique_ptr<Transport> open_local_socket(const std::string& path);

}  // namespace tactree::host
