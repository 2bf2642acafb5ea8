#include "tactree/client/announcement.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tactree/client/link_error.hpp"

namespace tactree::client {
namespace {

namespace fs = std::filesystem;

fs::path folder_of_user() {
  const char* const runtime = std::getenv("XDG_RUNTIME_DIR");  // NOLINT: no thread changes it
  if (runtime != nullptr && *runtime != '\0') {
    return fs::path(runtime) / "tactree";
  }
  std::error_code error;
  return fs::temp_directory_path(error) / ("tactree-" + std::to_string(::getuid()));
}

/// In the common folder for temporary files, another user may own a folder of this name.
bool is_own_folder(const fs::path& folder) {
  struct stat found {};
  return ::lstat(folder.c_str(), &found) == 0 && S_ISDIR(found.st_mode) &&
         found.st_uid == ::getuid() && (found.st_mode & 022U) == 0U;
}

/// Returns true if the program that wrote the file runs.
bool is_locked(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) {
    return false;
  }
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

}  // namespace

// Written and locked under a name that announced_ports() ignores: a file without a lock is removed.
Announcement::Announcement(const AnnouncedPort& announced) {
  const fs::path folder = folder_of_user();
  (void)::mkdir(folder.c_str(), 0700);
  if (!is_own_folder(folder)) {
    throw LinkError(folder.string() +
                    ": not a folder that only this user can change (set XDG_RUNTIME_DIR)");
  }
  std::string hidden = (folder / ".XXXXXX").string();
  descriptor_ = ::mkostemp(hidden.data(), O_CLOEXEC);
  path_ = (folder / fs::path(hidden).filename().string().substr(1)).string();
  const std::string text = announced.port + "\n" + announced.about + "\n";
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 ||
      ::write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::rename(hidden.c_str(), path_.c_str()) != 0) {
    const std::string cause = std::strerror(errno);
    ::unlink(hidden.c_str());
    ::close(descriptor_);
    throw LinkError(folder.string() + ": " + cause + " (is the folder writable?)");
  }
}

Announcement::~Announcement() {
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

std::vector<AnnouncedPort> announced_ports() {
  std::vector<AnnouncedPort> ports;
  const fs::path folder = folder_of_user();
  if (!is_own_folder(folder)) {
    return ports;
  }
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    AnnouncedPort announced;
    std::ifstream text(file);
    if (file.filename().string().starts_with('.') || !std::getline(text, announced.port) ||
        !std::getline(text, announced.about)) {
      continue;
    }
    if (is_locked(file)) {
      ports.push_back(std::move(announced));
    } else {
      ::unlink(file.c_str());
    }
  }
  std::sort(ports.begin(), ports.end(),
            [](const AnnouncedPort& a, const AnnouncedPort& b) { return a.port < b.port; });
  return ports;
}

}  // namespace tactree::client
