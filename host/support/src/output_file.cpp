#include "tactree/support/output_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "tactree/support/user_error.hpp"

namespace tactree::support {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file) {
  throw UserError(fmt::format("{}: cannot be written: {} (check the path and its permissions)",
                              file.string(), std::strerror(errno)));
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

bool write_bytes(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      return false;
    }
    bytes = bytes.subspan(written < 0 ? 0 : static_cast<std::size_t>(written));
  }
  return true;
}

bool flush(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL;  // EINVAL: a pipe or device
}

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  return write_bytes(descriptor, bytes) && flush(descriptor);
}

/// Gives the temporary file the permissions and the name of `file` and closes it. Returns false if
/// it fails or was not written; errno has the cause.
bool publish(int descriptor, bool written, const std::string& temporary, const fs::path& file) {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  written = written && ::fchmod(descriptor, 0666 & ~mask) == 0;
  written = ::close(descriptor) == 0 && written;
  return written && ::rename(temporary.c_str(), file.c_str()) == 0;
}

void write_in_place(const fs::path& file, std::span<const std::byte> bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  const bool written = descriptor >= 0 && write_all(descriptor, bytes);
  if (!written || ::close(descriptor) != 0) {
    fail(file);
  }
}

}  // namespace

bool is_written_in_place(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

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
  if (!publish(descriptor, write_all(descriptor, bytes), temporary, file)) {
    const int cause = errno;
    ::unlink(temporary.c_str());
    errno = cause;
    fail(file);
  }
}

void write_file(const fs::path& file, std::string_view text) {
  write_file(file, std::as_bytes(std::span(text)));
}

GrowingFile::GrowingFile(fs::path file) : file_(std::move(file)) {
  if (is_written_in_place(file_)) {
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    temporary_ = file_.string() + kIncomplete;
    descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  }
  if (descriptor_ < 0 && errno == EEXIST) {
    throw UserError(temporary_ +
                    ": exists; it holds the data of a program that was cut off (rename or delete "
                    "it)");
  }
  if (descriptor_ < 0) {
    fail(file_);
  }
}

GrowingFile::~GrowingFile() {
  if (descriptor_ < 0) {
    return;
  }
  ::close(descriptor_);
  if (bytes_ == 0U && !temporary_.empty()) {
    ::unlink(temporary_.c_str());
  }
}

void GrowingFile::append(std::string_view text) {
  if (!write_bytes(descriptor_, std::as_bytes(std::span(text)))) {
    const int error = errno;
    const auto size = static_cast<off_t>(bytes_);
    // A pipe cannot be truncated; its reader has received the bytes.
    if (::ftruncate(descriptor_, size) == 0) {
      (void)::lseek(descriptor_, size, SEEK_SET);
    }
    fail_with_remains(error);
  }
  bytes_ += text.size();
}

int GrowingFile::reserve(std::uint64_t bytes) const {
  return ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
}

void GrowingFile::finish() {
  const int descriptor = std::exchange(descriptor_, -1);
  const bool written = flush(descriptor);
  if (temporary_.empty() ? ::close(descriptor) != 0 || !written
                         : !publish(descriptor, written, temporary_, file_)) {
    fail_with_remains(errno);
  }
}

void GrowingFile::fail_with_remains(int error) const {
  throw UserError(fmt::format(
      "{}: cannot be written: {} (check the disk{})", file_.string(), std::strerror(error),
      temporary_.empty() || bytes_ == 0U ? "" : "; the preceding data are in " + temporary_));
}

}  // namespace tactree::support
