#pragma once
// Another program, started and ended with its owner.
//
//   Pipe output = make_pipe();
//   ChildProcess child({path, "argument"}, {.output = output.write_end.get()});
//   output.write_end.close();                     // or read() never sees the end of the output
//   ... read from output.read_end.get() ...
//   if (child.wait(limit) && !child.succeeded()) report(child.ending());
//
// The child is killed when the ChildProcess is destroyed, and by the kernel when the thread that
// started it ends: start it from a thread that lives as long as the ChildProcess.

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tactree::support {

/// Absolute path of the executable `name` in a folder of PATH; empty: not found.
[[nodiscard]] std::string find_program(const std::string& name);

/// Descriptors of the child. Its standard input is empty.
struct Streams {
  int output = -1;  ///< standard output; -1: discarded
  int error = -1;   ///< standard error; -1: discarded
  /// {number here, number in the child}; numbers in the child lie in 3..FileDescriptor::kLowest -
  /// 1, numbers here at or above FileDescriptor::kLowest.
  std::vector<std::pair<int, int>> inherited;
};

class ChildProcess {
 public:
  /// Starts `arguments`; the first is the program's path. Throws std::system_error when no process
  /// can be created. A program that cannot be executed ends with exit code 127.
  ChildProcess(const std::vector<std::string>& arguments, const Streams& streams);
  /// Kills the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits until the child ends, `limit` at most. True: it has ended.
  [[nodiscard]] bool wait(std::chrono::milliseconds limit);
  /// Ends the child with SIGKILL and waits for that. No effect after it has ended.
  void kill();

  // Precondition of the following: wait() returned true, or kill() was called.
  [[nodiscard]] bool succeeded() const { return status_ == 0; }
  /// Number of the signal that ended the child; nullopt: it exited by itself.
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
