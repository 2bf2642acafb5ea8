#include "tactree/support/named_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "tactree/support/output_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::support {

NamedOutput::NamedOutput(const std::filesystem::path& name) {
  if (name != "-" && name != "/dev/stdout") {
    file_ = name;
    return;
  }
  if (::isatty(STDOUT_FILENO) != 0) {
    throw UserError("standard output is a terminal (redirect it, or name a file)");
  }
  std::fflush(stdout);
  descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (descriptor_ < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    throw UserError(std::string("standard output cannot be used: ") + std::strerror(errno) +
                    " (open it)");
  }
}

NamedOutput::~NamedOutput() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

void NamedOutput::write(std::span<const std::byte> bytes) const {
  if (descriptor_ < 0) {
    write_file(file_, bytes);
    return;
  }
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      throw UserError(std::string("standard output cannot be written: ") + std::strerror(errno) +
                      " (check the disk or the pipe)");
    }
    bytes = bytes.subspan(written < 0 ? 0 : static_cast<std::size_t>(written));
  }
}

}  // namespace tactree::support
