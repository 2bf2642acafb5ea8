#include "gadget.hpp"

#include <fcntl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace tactree::hal::linux_usb {
namespace {

namespace fs = std::filesystem;

constexpr char kGadgets[] = "/sys/kernel/config/usb_gadget/";
constexpr char kControllers[] = "/sys/class/udc";

[[noreturn]] void fail(const std::string& file, int error, const std::string& remedy) {
  throw std::runtime_error(file + ": " + std::strerror(error) + " (remedy: " + remedy + ")");
}

/// configfs takes what one call writes.
void write_to(const std::string& file, const std::string& text) {
  const int opened = open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const bool written =
      opened >= 0 && write(opened, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int error = errno;
  if (opened >= 0) {
    close(opened);
  }
  if (!written) {
    fail(file, error,
         error == EBUSY ? "end the other program that uses this port" : "run it as root");
  }
}

void make(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    fail(folder, error.value(), "run it as root; modprobe libcomposite usb_f_fs");
  }
}

std::string hex(std::uint32_t value) {
  char text[16];
  (void)std::snprintf(text, sizeof(text), "0x%04x", value);
  return text;
}

}  // namespace

Gadget::Gadget(const core::usb::Identity& identity)
    : name_("tactree-" + std::to_string(getpid())),
      folder_(kGadgets + name_),
      mount_("/run/" + name_) {
  make(folder_);
  write_to(folder_ + "/idVendor", hex(identity.vendor));
  write_to(folder_ + "/idProduct", hex(identity.product));
  write_to(folder_ + "/bcdDevice", hex(identity.release));
  make(folder_ + "/strings/0x409");
  write_to(folder_ + "/strings/0x409/manufacturer", identity.maker);
  write_to(folder_ + "/strings/0x409/product", identity.name);
  write_to(folder_ + "/strings/0x409/serialnumber", core::usb::serial_text(identity).data());
  make(folder_ + "/configs/c.1");
  write_to(folder_ + "/configs/c.1/bmAttributes", "0xc0");  // motors are not fed by the bus
  write_to(folder_ + "/configs/c.1/MaxPower", "100");
  const std::string function = folder_ + "/functions/ffs." + name_;
  make(function);
  fs::create_symlink(function, folder_ + "/configs/c.1/ffs." + name_);
  // This kernel's own way to tell Windows that it needs no driver: version 1 of those descriptors.
  write_to(folder_ + "/os_desc/b_vendor_code", hex(core::usb::kMicrosoftRequest));
  write_to(folder_ + "/os_desc/qw_sign", "MSFT100");
  write_to(folder_ + "/os_desc/use", "1");
  fs::create_symlink(folder_ + "/configs/c.1", folder_ + "/os_desc/c.1");
  make(mount_);
  if (::mount(name_.c_str(), mount_.c_str(), "functionfs", 0, nullptr) != 0) {
    fail(mount_, errno, "run it as root; modprobe usb_f_fs");
  }
}

Gadget::~Gadget() {
  std::error_code ignored;
  try {
    write_to(folder_ + "/UDC", "\n");
  } catch (const std::runtime_error&) {  // it was not bound
  }
  umount2(mount_.c_str(), MNT_DETACH);
  fs::remove(mount_, ignored);
  fs::remove(folder_ + "/os_desc/c.1", ignored);
  fs::remove(folder_ + "/configs/c.1/ffs." + name_, ignored);
  fs::remove(folder_ + "/configs/c.1", ignored);
  fs::remove(folder_ + "/functions/ffs." + name_, ignored);
  fs::remove(folder_ + "/strings/0x409", ignored);
  fs::remove(folder_, ignored);
}

void Gadget::bind(const std::string& udc) { write_to(folder_ + "/UDC", udc); }

std::string only_udc() {
  std::string found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(kControllers, error)) {  // bound: controllers
    if (!found.empty()) {
      throw std::runtime_error(std::string(kControllers) +
                               ": several USB device ports (remedy: name one: " + found + ", " +
                               entry.path().filename().string() + ")");
    }
    found = entry.path().filename().string();
  }
  if (found.empty()) {
    throw std::runtime_error(std::string(kControllers) +
                             ": this computer has no USB device port (remedy: enable its driver)");
  }
  return found;
}

}  // namespace tactree::hal::linux_usb
