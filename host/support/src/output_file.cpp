#include "tactree/support/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file) {
  throw UserError(fmt::format("{}: cannot be written: {} (check the path and its permissions)",
                              file.string(), std::strerror(errno)));
}

// A device or pipe, such as /dev/stdout, must not be replaced by a regular file.
bool is_written_in_place(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void require_writable(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    errno = EISDIR;
    fail(file);
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!is_written_in_place(file) && !fs::is_directory(folder, ignored)) {
    errno = fs::exists(folder, ignored) ? ENOTDIR : ENOENT;
    fail(file);
  }
  const fs::path& changed = is_written_in_place(file) ? file : folder;
  if (::faccessat(AT_FDCWD, changed.c_str(), W_OK, AT_EACCESS) != 0) {
    fail(file);
  }
}

// True if two paths refer to the same file, also through links.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  const fs::path real = fs::weakly_canonical(fs::absolute(a, ignored), ignored);
  return fs::equivalent(a, b, ignored) ||
         (!real.empty() && real == fs::weakly_canonical(fs::absolute(b, ignored), ignored));
}

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      return false;
    }
    bytes = bytes.subspan(written < 0 ? 0 : static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0 || errno == EINVAL;  // EINVAL: a pipe or device
}

void write_in_place(const fs::path& file, std::span<const std::byte> bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const bool written = descriptor >= 0 && write_all(descriptor, bytes);
  if (!written || ::close(descriptor) != 0) {
    fail(file);
  }
}

}  // namespace

void check_outputs(const std::vector<fs::path>& outputs, const std::vector<fs::path>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const fs::path& output = outputs[i];
    if (output.empty()) {
      continue;
    }
    for (const fs::path& input : inputs) {
      if (!input.empty() && is_same_file(output, input)) {
        throw UserError(output.string() +
                        ": is an input and would be overwritten (choose another name)");
      }
    }
    for (std::size_t j = 0; j < i && !is_written_in_place(output); ++j) {
      if (!outputs[j].empty() && is_same_file(output, outputs[j])) {
        throw UserError(output.string() + ": is the name of two outputs (give each its own file)");
      }
    }
    require_writable(output);
  }
}

void write_file(const fs::path& file, std::span<const std::byte> bytes) {
  if (is_written_in_place(file)) {
    return write_in_place(file, bytes);
  }
  std::string temporary = file.string() + ".XXXXXX";
  const int descriptor = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (descriptor < 0) {
    fail(file);
  }
  const mode_t mask = ::umask(0);
  ::umask(mask);
  bool written = write_all(descriptor, bytes) && ::fchmod(descriptor, 0666 & ~mask) == 0;
  written = ::close(descriptor) == 0 && written;
  if (!written || ::rename(temporary.c_str(), file.c_str()) != 0) {
    const int cause = errno;
    ::unlink(temporary.c_str());
    errno = cause;
    fail(file);
  }
}

void write_file(const fs::path& file, std::string_view text) {
  write_file(file, std::as_bytes(std::span(text)));
}

}  // namespace tactree::support
