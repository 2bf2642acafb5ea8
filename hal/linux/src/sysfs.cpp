// Loop and memory annotations: docs/BOUND.md.

#include "sysfs.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "tactree/hal/linux/sysfs_error.hpp"

namespace tactree::hal::linux_gpio {
namespace {

namespace fs = std::filesystem;

constexpr int kPatience = 1000;  // ms; udev sets the group of a new channel's files with a delay

/// Entries of a class have a link to their device; entries of a bus are in the folder of their
/// device.
std::string device_of(const fs::path& entry) {
  std::error_code error;
  const fs::path link = fs::read_symlink(entry / "device", error);
  if (!error) {
    return link.filename().string();
  }
  return fs::canonical(entry, error).parent_path().filename().string();
}

}  // namespace

std::string quoted(const std::string& kind, const std::string& name) {
  return kind + " '" + name + "'";
}

std::string find_sysfs_device(const std::string& root, const std::string& name,
                              const std::string& kind) {
  std::error_code error;
  std::string others;
  for (const auto& entry : fs::directory_iterator(root, error)) {  // bound: devices
    const std::string device = device_of(entry.path());
    if (device == name) {
      return entry.path().string();
    }
    others += (others.empty() ? "" : ", ") + device;
  }
  if (error || others.empty()) {
    throw SysfsError(quoted(kind, name) + ": no such device in " + root +
                     " (hint: enable it in the device tree)");
  }
  throw SysfsError(quoted(kind, name) + ": no such device in " + root +
                   " (hint: use one of: " + others + ")");
}

FileDescriptor open_value(const std::string& file, int flags) {
  FileDescriptor opened(::open(file.c_str(), flags | O_CLOEXEC));
  for (int i = 0; i < kPatience && opened.get() < 0; ++i) {  // bound: kPatience
    ::usleep(1000);
    opened = FileDescriptor(::open(file.c_str(), flags | O_CLOEXEC));
  }
  if (opened.get() < 0) {
    throw SysfsError(file + ": " + std::strerror(errno) +
                     " (hint: join the group that owns it, or run as root)");
  }
  return opened;
}

bool write_value(int file, std::int64_t value) noexcept {
  std::array<char, 24> text{};
  char* const end = std::to_chars(text.data(), text.data() + text.size() - 1, value).ptr;
  *end = '\n';
  const auto size = static_cast<std::size_t>(end + 1 - text.data());
  return ::pwrite(file, text.data(), size, 0) == static_cast<ssize_t>(size);
}

bool read_value(int file, std::int64_t& value) noexcept {
  std::array<char, 24> text{};
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  return size > 0 && std::from_chars(text.data(), text.data() + size, value).ec == std::errc();
}

void set_value(const std::string& file, std::int64_t value, const std::string& remedy) {
  const FileDescriptor opened = open_value(file, O_WRONLY);
  if (!write_value(opened.get(), value)) {
    throw SysfsError(file + ": " + std::to_string(value) + ": " + std::strerror(errno) +
                     " (hint: " + remedy + ")");
  }
}

}  // namespace tactree::hal::linux_gpio
