#pragma once
// Boards by the name of the port they are at, whatever kind of port that is.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Ports at which a board may be. Cheap: nothing is opened.
[[nodiscard]] std::vector<std::string> list_ports();

/// By a name of list_ports(), "usb:" and a serial number, "unix:" or "step:" (lock_step.hpp) and
/// the path of a socket, or the path of any serial port. `baud` is for serial ports. Throws
/// LinkError.
[[nodiscard]] std::unique_ptr<Transport> open_port(const std::string& name, unsigned baud);

/// Bytes a second that the wire of such a port carries; none: its speed has no meaning there.
[[nodiscard]] std::optional<unsigned> wire_speed(const std::string& name, unsigned baud);

}  // namespace tactree::client
