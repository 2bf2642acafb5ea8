#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tactree/client/link_error.hpp"
#include "tactree/client/usb_devices.hpp"

namespace tactree::client {

std::string udev_rule() {
  // The property lists class, subclass and protocol of each interface; one must be the link's.
  return "# Tactree: local users may access haptic controllers.\n"
         "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", "
         "ENV{ID_USB_INTERFACES}==\"*:ff5401:*\", MODE=\"0660\", GROUP=\"plugdev\", "
         "TAG+=\"uaccess\"\n";
}

std::string install_udev_rule(const std::string& root) {
  // The name sorts before 73-seat-late.rules, which acts on the tag.
  const auto file = std::filesystem::path(root) / "etc/udev/rules.d/70-tactree.rules";
  std::error_code ignored;
  std::filesystem::create_directories(file.parent_path(), ignored);
  std::ofstream out(file);
  out << udev_rule();
  out.close();
  if (!out) {
    throw LinkError(file.string() + ": " + std::strerror(errno) +
                    " (hint: run it as root, or write the rule to this file manually)");
  }
  return file.string();
}

}  // namespace tactree::client
