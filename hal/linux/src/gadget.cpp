// Loop and memory annotations: docs/BOUND.md.

#include "gadget.hpp"

#include <fcntl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "tactree/hal/linux/function_fs_controller.hpp"

namespace tactree::hal::linux_usb {
namespace {

namespace fs = std::filesystem;

constexpr char kGadgets[] = "/sys/kernel/config/usb_gadget/";
constexpr char kPrefix[] = "tactree-";
constexpr char kControllers[] = "/sys/class/udc";

std::string mount_of(const std::string& name) { return "/run/" + name; }

[[noreturn]] void fail(const std::string& file, int error, const std::string& remedy) {
  throw std::runtime_error(file + ": " + std::strerror(error) + " (hint: " + remedy + ")");
}

/// Writes in one system call, as configfs requires.
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
    : name_(kPrefix + std::to_string(getpid())),
      folder_(kGadgets + name_),
      mount_(mount_of(name_)) {
  take_down_left_over();
  make(folder_);
  write_to(folder_ + "/idVendor", hex(identity.vendor));
  write_to(folder_ + "/idProduct", hex(identity.product));
  write_to(folder_ + "/bcdDevice", hex(identity.release));
  make(folder_ + "/strings/0x409");
  write_to(folder_ + "/strings/0x409/manufacturer", identity.maker);
  write_to(folder_ + "/strings/0x409/product", identity.name);
  write_to(folder_ + "/strings/0x409/serialnumber", core::usb::serial_text(identity).data());
  make(folder_ + "/configs/c.1");
  write_to(folder_ + "/configs/c.1/bmAttributes", "0xc0");  // self-powered
  write_to(folder_ + "/configs/c.1/MaxPower", "100");
  const std::string function = folder_ + "/functions/ffs." + name_;
  make(function);
  fs::create_symlink(function, folder_ + "/configs/c.1/ffs." + name_);
  // Microsoft OS descriptors of version 1, which configfs supports: Windows loads WinUSB.
  write_to(folder_ + "/os_desc/b_vendor_code", hex(core::usb::kMicrosoftRequest));
  write_to(folder_ + "/os_desc/qw_sign", "MSFT100");
  write_to(folder_ + "/os_desc/use", "1");
  fs::create_symlink(folder_ + "/configs/c.1", folder_ + "/os_desc/c.1");
  make(mount_);
  if (::mount(name_.c_str(), mount_.c_str(), "functionfs", 0, nullptr) != 0) {
    fail(mount_, errno, "run it as root; modprobe usb_f_fs");
  }
}

Gadget::~Gadget() { take_down(name_); }

void Gadget::take_down(const std::string& name) {
  const std::string folder = kGadgets + name;
  const std::string mount = mount_of(name);
  std::error_code ignored;
  try {
    write_to(folder + "/UDC", "\n");
  } catch (const std::runtime_error&) {  // the gadget was not bound
  }
  umount2(mount.c_str(), MNT_DETACH);
  fs::remove(mount, ignored);
  fs::remove(folder + "/os_desc/c.1", ignored);
  fs::remove(folder + "/configs/c.1/ffs." + name, ignored);
  fs::remove(folder + "/configs/c.1", ignored);
  fs::remove(folder + "/functions/ffs." + name, ignored);
  fs::remove(folder + "/strings/0x409", ignored);
  fs::remove(folder, ignored);
}

/// Removes gadgets of processes that have ended. The name of a gadget contains its process ID.
void Gadget::take_down_left_over() {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(kGadgets, error)) {  // bound: gadgets
    const std::string name = entry.path().filename().string();
    pid_t process = 0;
    if (name.starts_with(kPrefix)) {
      (void)std::from_chars(name.data() + sizeof(kPrefix) - 1, name.data() + name.size(), process);
    }
    if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) {
      take_down(name);
    }
  }
}

void Gadget::bind(const std::string& udc) { write_to(folder_ + "/UDC", udc); }

std::string find_udc(const std::string& name) {
  std::string found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(kControllers, error)) {  // bound: controllers
    std::string port = entry.path().filename().string();
    if (port == name) {
      return port;
    }
    found += (found.empty() ? "" : ", ") + port;
  }
  const std::string where = std::string(kControllers) + ": ";
  if (found.empty()) {
    throw std::runtime_error(where +
                             "this computer has no USB device port (hint: enable its driver)");
  }
  if (!name.empty()) {
    throw std::runtime_error(where + "no USB device port is '" + name +
                             "' (hint: name one of: " + found + ")");
  }
  if (found.find(',') != std::string::npos) {
    throw std::runtime_error(where + "several USB device ports (hint: name one of: " + found + ")");
  }
  return found;
}

}  // namespace tactree::hal::linux_usb
