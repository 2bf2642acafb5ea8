#include "tactree/hal/linux/watchdog.hpp"

#include <fcntl.h>
#include <linux/watchdog.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>

namespace tactree::hal {
namespace {

[[noreturn]] void fail(const std::string& file, const char* remedy) {
  throw WatchdogError(file + ": " + std::strerror(errno) + " (remedy: " + remedy + ")");
}

const char* remedy_for(int error) {
  if (error == EBUSY) {
    return "another program has it; systemd does where RuntimeWatchdogSec is set";
  }
  return error == ENOENT ? "load its driver, or leave the watchdog out"
                         : "run as root, or let a udev rule allow it";
}

}  // namespace

WatchdogDevice::WatchdogDevice(const std::string& file, std::uint32_t timeout_s)
    : file_(::open(file.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (file_.get() < 0) {
    fail(file, remedy_for(errno));
  }
  int seconds = static_cast<int>(timeout_s);
  if (ioctl(file_.get(), WDIOC_SETTIMEOUT, &seconds) != 0) {
    const int error = errno;
    (void)::write(file_.get(), "V", 1);
    errno = error;
    fail(file, "give a time that this watchdog can do");
  }
}

WatchdogDevice::~WatchdogDevice() {
  if (file_.get() >= 0) {
    (void)!::write(file_.get(), "V", 1);  // closing it without this is what a crash does
  }
}

void WatchdogDevice::kick() noexcept { (void)ioctl(file_.get(), WDIOC_KEEPALIVE, 0); }

}  // namespace tactree::hal
