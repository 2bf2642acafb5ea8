#include "child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

extern char** environ;

namespace tactree::builder {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 16;

/// Starts the program with its output on `output`, no input, and its errors nowhere.
int spawn(const std::vector<std::string>& arguments, int output, pid_t& pid) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const int error = ::posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, double seconds)
    : seconds_(seconds),
      deadline_(std::chrono::steady_clock::now() +
                std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                    std::chrono::duration<double>(seconds))),
      buffer_(kBufferBytes) {
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category());
  const int error = spawn(arguments, ends[1], pid_);
  ::close(ends[1]);
  output_ = ends[0];
  if (error == 0) return;
  ::close(output_);
  throw std::system_error(error, std::generic_category());
}

ChildProcess::~ChildProcess() {
  kill_and_reap();
  ::close(output_);
}

void ChildProcess::kill_and_reap() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

bool ChildProcess::wait_for_output() {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline_ - std::chrono::steady_clock::now());
    const auto wait = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 60'000));
    pollfd waiting{output_, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, wait);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
    if (left.count() <= 0) return false;
  }
}

bool ChildProcess::refill() {
  while (wait_for_output()) {
    const ssize_t got = ::read(output_, buffer_.data(), buffer_.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(got);
    return true;
  }
  return false;
}

bool ChildProcess::read(void* into, std::size_t size) {
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

std::string ChildProcess::wait_and_describe_end() {
  const std::string too_slow = fmt::format("took more than {:g} seconds and was stopped", seconds_);
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(pid_, &status, WNOHANG)) == 0) {
    if (std::chrono::steady_clock::now() >= deadline_) {
      kill_and_reap();
      return too_slow;
    }
    ::poll(nullptr, 0, 1);
  }
  pid_ = -1;
  if (ended > 0 && WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU) return too_slow;
    return fmt::format("crashed (signal {}, {})", signal, ::strsignal(signal));
  }
  if (ended > 0 && WIFEXITED(status)) {
    return fmt::format("ended before its result was complete (exit code {})", WEXITSTATUS(status));
  }
  return "ended before its result was complete";
}

}  // namespace tactree::builder
