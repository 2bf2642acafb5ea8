#include "tactree/client/ports.hpp"

#include <filesystem>
#include <string_view>

#include "tactree/client/local_socket.hpp"
#include "tactree/client/lock_step.hpp"
#include "tactree/client/serial_port.hpp"
#include "tactree/client/usb_transport.hpp"

namespace tactree::client {
namespace {

constexpr std::string_view kUsb = "usb:";
constexpr std::string_view kSocket = "unix:";
constexpr std::string_view kStep = "step:";

}  // namespace

std::vector<std::string> list_ports() {
  std::vector<std::string> ports;
  for (const std::string& path : usb_paths()) {
    ports.push_back(std::string(kUsb) + path);
  }
  for (std::string& port : serial_ports()) {
    ports.push_back(std::move(port));
  }
  return ports;
}

std::unique_ptr<Transport> open_port(const std::string& name, unsigned baud) {
  if (name.starts_with(kUsb)) {
    return open_usb(name.substr(kUsb.size()));
  }
  if (name.starts_with(kSocket)) {
    return open_local_socket(name.substr(kSocket.size()));
  }
  if (name.starts_with(kStep)) {
    return open_lock_step(name.substr(kStep.size()));
  }
  return open_serial_port(name, baud);
}

std::optional<unsigned> wire_speed(const std::string& name, unsigned baud) {
  constexpr unsigned kBitsPerByte = 10;  // with start and stop bit
  std::error_code error;
  const std::string path = std::filesystem::canonical(name, error).string();
  const bool has_no_wire = name.starts_with(kUsb) || name.starts_with(kSocket) ||
                           name.starts_with(kStep) || path.starts_with("/dev/pts/") ||
                           path.starts_with("/dev/ttyACM");
  return has_no_wire ? std::nullopt : std::optional(baud / kBitsPerByte);
}

}  // namespace tactree::client
