#include "child_output.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

namespace tactree::builder {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;
constexpr milliseconds kMaxPoll{60'000};

}  // namespace

ChildOutput::ChildOutput(const std::vector<std::string>& arguments, double seconds,
                         Clock::time_point (*now)())
    : seconds_(seconds),
      now_(now),
      deadline_(now_() + std::chrono::duration_cast<Clock::duration>(
                             std::chrono::duration<double>(seconds))),
      pipe_(support::make_pipe()),
      child_(arguments, {.output = pipe_.write_end.get(), .error = -1, .inherited = {}}),
      buffer_(kBufferBytes) {
  pipe_.write_end.close();
}

milliseconds ChildOutput::time_left() const {
  return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(deadline_ - now_()));
}

bool ChildOutput::wait_for_output() const {
  while (true) {
    const milliseconds left = time_left();
    pollfd waiting{pipe_.read_end.get(), POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::min(left, kMaxPoll).count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
    if (left.count() == 0) return false;
  }
}

bool ChildOutput::refill() {
  while (wait_for_output()) {
    const ssize_t got = ::read(pipe_.read_end.get(), buffer_.data(), buffer_.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(got);
    return true;
  }
  return false;
}

bool ChildOutput::read(void* into, std::size_t size) {
  char* to = static_cast<char*>(into);
  while (size > 0) {
    if (begin_ == end_ && !refill()) return false;
    const std::size_t part = std::min(size, end_ - begin_);
    std::memcpy(to, buffer_.data() + begin_, part);
    begin_ += part;
    to += part;
    size -= part;
  }
  return true;
}

std::string ChildOutput::wait_and_describe_end() {
  const std::string too_slow = fmt::format("took more than {:g} seconds and was stopped", seconds_);
  if (!child_.wait(time_left())) {
    child_.kill();
    return too_slow;
  }
  if (const std::optional<int> signal = child_.signal()) {
    if (*signal == SIGXCPU) return too_slow;
    return fmt::format("crashed (signal {}, {})", *signal, ::strsignal(*signal));
  }
  return fmt::format("ended before its result was complete (exit code {})", child_.exit_code());
}

}  // namespace tactree::builder
