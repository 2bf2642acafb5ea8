#include "tactree/support/child_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "tactree/support/high_descriptor.hpp"

namespace tactree::support {
namespace {

constexpr int kCannotStart = 127;

// Runs between fork and exec. Makes system calls only, because another thread may have held any
// lock at the fork.
[[noreturn]] void become(char* const* arguments, const Streams& streams, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::setpgid(0, 0);  // Ctrl-C at the terminal is for the parent, which ends the child
  const int nothing = ::open("/dev/null", O_RDWR);
  const auto use = [nothing](int descriptor, int number) {
    return ::dup2(descriptor < 0 ? nothing : descriptor, number) == number;
  };
  bool good = ::getppid() == parent && nothing >= 0 && use(nothing, STDIN_FILENO) &&
              use(streams.output, STDOUT_FILENO) && use(streams.error, STDERR_FILENO);
  if (nothing > STDERR_FILENO) {
    ::close(nothing);
  }
  for (const auto& [ours, theirs] : streams.inherited) {
    good = good && use(ours, theirs);
  }
  if (good) {
    ::execv(arguments[0], arguments);
  }
  ::_exit(kCannotStart);
}

}  // namespace

std::string find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::string candidate = folder;
    candidate.append("/").append(name);
    if (::access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
  }
  return {};
}

ChildProcess::ChildProcess(const std::vector<std::string>& arguments, const Streams& streams) {
  std::vector<std::string> copies = arguments;  // execv() takes pointers to non-const
  std::vector<char*> pointers;
  pointers.reserve(copies.size() + 1);
  for (std::string& argument : copies) {
    pointers.push_back(argument.data());
  }
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) {
    fail_with_errno(arguments.front().c_str());
  }
  if (pid_ == 0) {
    become(pointers.data(), streams, parent);
  }
}

ChildProcess::~ChildProcess() { kill(); }

void ChildProcess::kill() {
  if (ended_) {
    return;
  }
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  ended_ = true;
}

bool ChildProcess::wait(std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!ended_) {
    ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
    if (ended_ || std::chrono::steady_clock::now() >= end) {
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return ended_;
}

std::optional<int> ChildProcess::signal() const {
  return WIFSIGNALED(status_) ? std::optional(WTERMSIG(status_)) : std::nullopt;
}

int ChildProcess::exit_code() const { return WEXITSTATUS(status_); }

std::string ChildProcess::ending() const {
  if (const std::optional<int> number = signal()) {
    return "killed by signal " + std::to_string(*number);
  }
  return "exit code " + std::to_string(exit_code());
}

}  // namespace tactree::support
