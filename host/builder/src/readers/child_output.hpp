#pragma once
// Reads the standard output of a child process, with a time limit.

#include <chrono>
#include <string>
#include <vector>

#include "tactree/support/child_process.hpp"
#include "tactree/support/high_descriptor.hpp"

namespace tactree::builder {

class ChildOutput {
 public:
  using Clock = std::chrono::steady_clock;

  /// Starts the program arguments[0], which is killed when this object is destroyed. Throws
  /// std::system_error. `now` is the clock of the time limit.
  ChildOutput(const std::vector<std::string>& arguments, double seconds,
              Clock::time_point (*now)() = &Clock::now);

  /// Reads the next `size` bytes of the output. Returns false if the output ends earlier or the
  /// time limit has passed.
  [[nodiscard]] bool read(void* into, std::size_t size);

  /// Call after read() has returned false. Waits for the end of the child and describes it for a
  /// message.
  [[nodiscard]] std::string wait_and_describe_end();

 private:
  [[nodiscard]] bool refill();
  [[nodiscard]] bool wait_for_output() const;
  [[nodiscard]] std::chrono::milliseconds time_left() const;

  double seconds_;
  Clock::time_point (*now_)();
  Clock::time_point deadline_;
  support::Pipe pipe_;
  support::ChildProcess child_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // unread part of buffer_
  std::size_t end_ = 0;
};

}  // namespace tactree::builder
