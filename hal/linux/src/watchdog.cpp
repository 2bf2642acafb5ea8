#include "tactree/hal/linux/watchdog.hpp"

#include <fcntl.h>
#include <linux/watchdog.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>

namespace tactree::hal {
namespace {

[[noreturn]] void fail(const std::string& file, const char* remedy) {
  throw WatchdogError(file + ": " + std::strerror(errno) + " (hint: " + remedy + ")");
}

const char* remedy_for(int error) {
  if (error == EBUSY) {
    return "end the program that uses it; systemd uses it if RuntimeWatchdogSec is set";
  }
  return error == ENOENT ? "load its driver, or configure no watchdog"
                         : "run as root, or add a udev rule that permits it";
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
    fail(file, "use a timeout supported by this watchdog");
  }
}

WatchdogDevice::~WatchdogDevice() {
  if (file_.get() >= 0) {
    (void)!::write(file_.get(), "V", 1);  // magic close; without it the driver assumes a crash
  }
}

void WatchdogDevice::kick() noexcept { (void)ioctl(file_.get(), WDIOC_KEEPALIVE, 0); }

}  // namespace tactree::hal
