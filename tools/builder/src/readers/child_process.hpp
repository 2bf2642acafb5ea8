#pragma once
// Another program whose standard output is read through a pipe, with a limit on the time.

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace tactree::builder {

class ChildProcess {
 public:
  /// Starts the program arguments[0]. Throws std::system_error when that fails.
  ChildProcess(const std::vector<std::string>& arguments, double seconds);
  /// Ends the child, if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Fills `into` with the next `size` bytes of its output. False when the output ends before, or
  /// the time is over.
  [[nodiscard]] bool read(void* into, std::size_t size);

  /// After read() gave false: waits for the end, and says in words how it came about.
  [[nodiscard]] std::string wait_and_describe_end();

 private:
  [[nodiscard]] bool refill();
  [[nodiscard]] bool wait_for_output();
  void kill_and_reap();

  pid_t pid_ = -1;
  int output_ = -1;
  double seconds_;
  std::chrono::steady_clock::time_point deadline_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace tactree::builder
