#pragma once
// A simulated board whose time passes only as its program lets it. A program that is slow, or held
// in a debugger, loses no link, and a test has the same outcome on every machine.
//
// The two sides exchange packets over a socket in the file system. The program sends the time that
// may pass, us, as 4 bytes in the host's order, then bytes for the board. The board simulates that
// time, or less if it has something to say, and answers with its own time, us, as 8 bytes, then the
// bytes from the board.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// The program's side. Throws LinkError: nobody is there, no permission.
[[nodiscard]] std::unique_ptr<Transport> open_lock_step(const std::string& path);

/// The board's side. Several programs share it like a wire: each receives all that the board sends,
/// and time passes while all of them let it. Without a program it stands still.
class LockStepServer : public Transport {
 public:
  /// Listens at a new path in the folder for temporary files. Throws LinkError.
  LockStepServer();
  ~LockStepServer() override;

  /// After each tick, which took `tick` of the simulated time. Returns when the next tick may run,
  /// or soon after `ended` is true.
  void pass(std::chrono::nanoseconds tick, const std::function<bool()>& ended);

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds) override {}
  /// Simulated time.
  [[nodiscard]] std::chrono::microseconds now() const override;
  [[nodiscard]] bool connected() const override { return true; }
  /// What programs open: "step:" and the path.
  [[nodiscard]] std::string name() const override;

 private:
  struct Program {
    int descriptor = -1;
    bool asked = false;  ///< its request has no answer yet
    std::chrono::nanoseconds until{0};
    std::vector<std::byte> out;
  };

  explicit LockStepServer(int listening) : listening_(listening) {}
  void answer_what_is_due();
  [[nodiscard]] bool all_wait() const;
  void take_requests();
  void take_request(Program& program);

  std::string path_;
  int listening_;
  std::chrono::nanoseconds now_{0};
  std::vector<Program> programs_;
  std::vector<std::byte> in_;
};

}  // namespace tactree::client
