#pragma once
// A child process that ends with its owner.
//
//   Pipe output = make_pipe();
//   ChildProcess child({path, "argument"}, {.output = output.write_end.get()});
//   output.write_end.close();                     // otherwise read() never reaches the end
//   ... read from output.read_end.get() ...
//   if (child.wait(limit) && !child.succeeded()) report(child.ending());
//
// The child is killed when the ChildProcess is destroyed. The kernel also kills it when the thread
// that started it ends, so start it from a thread that lives as long as the ChildProcess.

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactree::support {

/// Path of the executable `name` in a folder of PATH; empty if it is not found.
[[nodiscard]] std::string find_program(const std::string& name);

/// Descriptors of the child. Its standard input is empty.
struct Streams {
  int output = -1;  ///< standard output; -1 discards it
  int error = -1;   ///< standard error; -1 discards it
  /// Pairs {number in this process, number in the child}. Numbers in the child are 3 ..
  /// HighDescriptor::kMinNumber - 1, and numbers in this process are at least
  /// HighDescriptor::kMinNumber, so no descriptor is overwritten before it is passed.
  std::vector<std::pair<int, int>> inherited;
};

class ChildProcess {
 public:
  /// Starts the program with the path arguments[0]. Throws std::system_error if no process can be
  /// created. If the program cannot be executed, the exit code is 127.
  ChildProcess(const std::vector<std::string>& arguments, const Streams& streams);
  /// Kills the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits until the child ends, for `limit` at most. Returns true if it has ended.
  [[nodiscard]] bool wait(std::chrono::milliseconds limit);
  /// Kills the child with SIGKILL and waits until it has ended. Has no effect if it already has.
  void kill();

  // Precondition of the following functions: wait() returned true, or kill() was called.
  [[nodiscard]] bool succeeded() const { return status_ == 0; }
  /// Number of the signal that ended the child; nullopt if it exited normally.
  [[nodiscard]] std::optional<int> signal() const;
  [[nodiscard]] int exit_code() const;
  /// "exit code 1" or "killed by signal 9", for messages.
  [[nodiscard]] std::string ending() const;

 private:
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

}  // namespace tactree::support
