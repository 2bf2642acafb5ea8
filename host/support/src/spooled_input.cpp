#include "tactree/support/spooled_input.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

[[noreturn]] void fail_to_store(const std::filesystem::path& folder, const std::string& cause) {
  refuse(kStandardInputName, fmt::format("it cannot be stored in {}: {}", folder.string(), cause),
         "set TMPDIR to a folder with enough room, or save it to a file and give that");
}

/// Returns false on failure, with the cause in errno.
bool write_all(int descriptor, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(descriptor, bytes, count);
    if (written < 0 && errno != EINTR) {
      return false;
    }
    const auto part = static_cast<std::size_t>(written < 0 ? 0 : written);
    bytes += part;
    count -= part;
  }
  return true;
}

}  // namespace

std::uint64_t free_space(const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? 0 : space.available;
}

std::filesystem::path SpooledInput::default_folder() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  return error ? std::filesystem::path("/tmp") : folder;
}

SpooledInput::SpooledInput(int descriptor, const std::filesystem::path& folder,
                           const FreeSpace& space) {
  if (::isatty(descriptor) != 0) {
    refuse(kStandardInputName, "it is a terminal, not a file",
           "connect it to a file or a program: tactree build - < FILE");
  }
  std::string name = (folder / "tactree-XXXXXX").string();
  copy_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (copy_ < 0) {
    fail_to_store(folder, std::strerror(errno));
  }
  ::unlink(name.c_str());
  try {
    copy(descriptor, folder, space);
  } catch (...) {
    ::close(copy_);
    throw;
  }
}

SpooledInput::~SpooledInput() { ::close(copy_); }

void SpooledInput::copy(int from, const std::filesystem::path& folder,
                        const FreeSpace& space) const {
  std::vector<char> block(kBlockBytes);
  std::uint64_t copied = 0;
  while (true) {
    const ssize_t got = ::read(from, block.data(), block.size());
    if (got == 0) {
      return;
    }
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      refuse(kStandardInputName, fmt::format("reading failed: {}", std::strerror(errno)),
             "check the program that writes to it");
    }
    const auto bytes = static_cast<std::size_t>(got);
    if (space(folder) < kSpoolReserve + bytes) {
      fail_to_store(folder, fmt::format("after {} MiB, less than {} MiB are free there",
                                        copied >> 20U, kSpoolReserve >> 20U));
    }
    if (!write_all(copy_, block.data(), bytes)) {
      fail_to_store(folder, std::strerror(errno));
    }
    copied += bytes;
  }
}

std::filesystem::path SpooledInput::path() const {
  return fmt::format("/proc/{}/fd/{}", ::getpid(), copy_);
}

}  // namespace tactree::support
