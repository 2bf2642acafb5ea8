#include "tactree/host/ports.hpp"

#include "tactree/host/serial_port.hpp"

namespace tactree::host {

std::vector<std::string> list_ports() { return serial_ports(); }

std::unique_ptr<Transport> open_port(const std::string& name, unsigned baud) {
  return open_serial_port(name, baud);
}

}  // namespace tactree::host
