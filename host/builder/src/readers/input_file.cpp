#include "input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "tactree/builder/scan.hpp"

namespace tactree::builder {
namespace {

constexpr std::size_t kReadAheadBytes = std::size_t{1} << 20;

[[noreturn]] void throw_open_error(const std::string& name, int error) {
  if (error == ENOENT || error == ENOTDIR) {
    throw ReadError(name, "", "there is no such file", "check the path");
  }
  if (error == EACCES || error == EPERM) {
    throw ReadError(name, "", "the file cannot be read: permission denied",
                    "give yourself read permission, for example with chmod u+r");
  }
  throw ReadError(name, "", fmt::format("the file cannot be opened: {}", std::strerror(error)), "");
}

std::string kind_of(mode_t mode) {
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path, std::function<void(double)> progress,
                     std::string label)
    : name_(label.empty() ? path.string() : std::move(label)), progress_(std::move(progress)) {
  // With O_NONBLOCK, opening a pipe does not wait for a writer.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw_open_error(name_, errno);
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  const bool usable = known && S_ISREG(status.st_mode) && status.st_size > 0;
  if (usable) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size_, kReadAheadBytes)));
    return;
  }
  ::close(descriptor_);
  if (!known) throw_open_error(name_, errno);
  if (!S_ISREG(status.st_mode)) {
    throw ReadError(name_, "", fmt::format("this is {}, not a file", kind_of(status.st_mode)),
                    S_ISDIR(status.st_mode) ? "name the scan files inside it"
                                            : "save the scan to a file first");
  }
  throw ReadError(name_, "", "the file is empty (0 bytes)", "export or copy it again");
}

InputFile::~InputFile() { ::close(descriptor_); }

void InputFile::skip(std::uint64_t count) {
  count = std::min(count, remaining());
  const std::size_t buffered = end_ - begin_;
  if (count <= buffered) {
    begin_ += static_cast<std::size_t>(count);
    return;
  }
  buffer_offset_ = offset() + count;
  begin_ = end_ = 0;
}

bool InputFile::only_zeros_left() {
  while (true) {
    const std::string_view bytes = peek(1);
    if (bytes.empty()) return true;
    const std::size_t other = bytes.find_first_not_of('\0');
    if (other != std::string_view::npos) return false;
    consume(bytes.size());
  }
}

void InputFile::rewind() {
  buffer_offset_ = 0;
  begin_ = end_ = 0;
  line_number_ = 0;
}

void InputFile::fill(std::size_t wanted) {
  wanted = std::min(wanted, kMaxPeekBytes);
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  buffer_offset_ += begin_;
  end_ -= begin_;
  begin_ = 0;
  if (buffer_.size() < wanted) {
    buffer_.resize(static_cast<std::size_t>(
        std::min<std::uint64_t>(size_ - buffer_offset_, std::max(wanted, 2 * buffer_.size()))));
  }
  while (end_ < buffer_.size() && buffer_offset_ + end_ < size_) {
    const std::uint64_t at = buffer_offset_ + end_;
    const std::size_t room =
        static_cast<std::size_t>(std::min<std::uint64_t>(buffer_.size() - end_, size_ - at));
    const ssize_t got = ::pread(descriptor_, buffer_.data() + end_, room, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      throw ReadError(name_, fmt::format("byte {}", at),
                      fmt::format("reading failed: {}", std::strerror(errno)),
                      "check the disk and copy the file again");
    }
    if (got == 0) {  // another process truncated the file
      size_ = at;
      break;
    }
    end_ += static_cast<std::size_t>(got);
  }
  if (progress_) {
    progress_(size_ == 0 ? 1.0 : static_cast<double>(buffer_offset_) / static_cast<double>(size_));
  }
}

void InputFile::find_line_end_character() {
  const std::string_view head = peek(std::size_t{1} << 16);
  const bool old_mac = head.find('\n') == std::string_view::npos && head.find('\r') != head.npos;
  line_end_ = old_mac ? '\r' : '\n';
}

bool InputFile::next_line(std::string_view& line) {
  if (line_end_ == '\0') find_line_end_character();
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (offset() == 0 && peek(kByteOrderMark.size()).starts_with(kByteOrderMark)) {
    consume(kByteOrderMark.size());
  }
  std::string_view text = peek(1);
  if (text.empty()) return false;
  ++line_number_;
  std::size_t length = text.find(line_end_);
  while (length == std::string_view::npos && text.size() < remaining()) {
    if (text.size() > kMaxLineBytes) break;
    const std::size_t searched = text.size();
    text = peek(std::min(2 * searched, searched + kReadAheadBytes));
    length = text.find(line_end_, searched);
    if (text.size() == searched) break;
  }
  const bool ended = length != std::string_view::npos;
  if (!ended) length = text.size();
  if (length > kMaxLineBytes) {
    throw ReadError(
        name_, line_place(), "the line is longer than 1 MiB",
        "the file is damaged, or is not in the text format that its beginning suggests");
  }
  line = text.substr(0, length);
  consume(ended ? length + 1 : length);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

std::string InputFile::line_place() const { return fmt::format("line {}", line_number_); }

}  // namespace tactree::builder
