#pragma once
// A program that runs beside us and never outlives us.

#include <sys/types.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "file_descriptor.hpp"

namespace tactree::emulation {

/// Full path of a program in PATH; empty: there is none.
[[nodiscard]] std::string find_program(const std::string& name);

class ChildProcess {
 public:
  /// Starts `arguments`, the first being the program's path. Each of `inherited` is {ours, number
  /// in the child}; standard input is empty, standard output and error go to `log`.
  ChildProcess(const std::vector<std::string>& arguments,
               const std::vector<std::pair<int, int>>& inherited, int log);
  /// Kills it.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Has it ended within this time?
  [[nodiscard]] bool wait(std::chrono::milliseconds limit);
  /// "exit code 1", "killed by signal 9". Precondition: wait() was true.
  [[nodiscard]] std::string how_it_ended() const;
  [[nodiscard]] bool succeeded() const { return status_ == 0; }

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

}  // namespace tactree::emulation
