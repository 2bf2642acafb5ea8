#pragma once
// Opens boards by port name, for all kinds of ports.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Ports to which a board may be connected. Opens none of them.
[[nodiscard]] std::vector<std::string> list_ports();

/// Opens a port. `name`: a name of list_ports(); "usb:" and a serial number; "unix:" or "step:"
/// (lock_step.hpp) and the path of a socket; or the path of any serial port. `baud` is for serial
/// ports. Throws LinkError.
[[nodiscard]] std::unique_ptr<Transport> open_port(const std::string& name, unsigned baud);

/// Bytes per second on the wire of such a port; empty if the port has no wire with that speed.
[[nodiscard]] std::optional<unsigned> wire_speed(const std::string& name, unsigned baud);

}  // namespace tactree::client
