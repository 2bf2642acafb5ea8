#include "child_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <sstream>
#include <thread>

namespace tactree::emulation {
namespace {

constexpr int kCannotStart = 127;

// Between fork and exec: nothing but system calls.
[[noreturn]] void become(char* const* arguments, const std::vector<std::pair<int, int>>& inherited,
                         int log, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nothing = ::open("/dev/null", O_RDONLY);
  bool good = ::getppid() == parent && ::dup2(nothing, 0) == 0 && ::dup2(log, 1) == 1 &&
              ::dup2(log, 2) == 2;
  for (const auto& [ours, theirs] : inherited) {
    good = good && ::dup2(ours, theirs) == theirs;
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
    const std::string candidate = folder + "/" + name;
    if (::access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
  }
  return {};
}

ChildProcess::ChildProcess(const std::vector<std::string>& arguments,
                           const std::vector<std::pair<int, int>>& inherited, int log) {
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) {
    pointers.push_back(const_cast<char*>(argument.c_str()));
  }
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) {
    fail_with_errno("emulation: " + arguments.front());
  }
  if (pid_ == 0) {
    become(pointers.data(), inherited, log, parent);
  }
}

ChildProcess::~ChildProcess() {
  if (!ended_) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, &status_, 0);
  }
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

std::string ChildProcess::how_it_ended() const {
  if (WIFSIGNALED(status_)) {
    return "killed by signal " + std::to_string(WTERMSIG(status_));
  }
  return "exit code " + std::to_string(WEXITSTATUS(status_));
}

}  // namespace tactree::emulation
