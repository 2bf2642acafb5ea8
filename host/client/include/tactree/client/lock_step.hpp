#pragma once
// A simulated board whose time passes only as far as its program grants. A program that is slow, or
// stopped in a debugger, does not lose the link, and a test has the same outcome on every machine.
//
// Both sides exchange packets over a Unix domain socket. The program sends the granted time, us, as
// 4 bytes in host byte order, then bytes for the board. The board simulates that time, or less if
// it has data to send, and replies with its time, us, as 8 bytes, then bytes for the program.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tactree/client/transport.hpp"

namespace tactree::client {

/// Opens the program's side. Throws LinkError if no board listens or permission is missing.
[[nodiscard]] std::unique_ptr<Transport> open_lock_step(const std::string& path);

/// The board's side. Several programs share it like a bus: each receives all bytes that the board
/// sends, and time passes only while all of them grant it. Without a program, time stands still.
class LockStepServer : public Transport {
 public:
  /// Listens at a new path in the folder for temporary files. Throws LinkError.
  LockStepServer();
  ~LockStepServer() override;

  /// Call after each tick, which took `tick` of the simulated time. Returns when the next tick may
  /// run, or shortly after `ended` returns true.
  void pass(std::chrono::nanoseconds tick, const std::function<bool()>& ended);

  [[nodiscard]] std::size_t read(std::span<std::byte> bytes) override;
  [[nodiscard]] std::size_t write(std::span<const std::byte> bytes) override;
  void wait(std::chrono::microseconds) override {}
  /// Simulated time.
  [[nodiscard]] std::chrono::microseconds now() const override;
  [[nodiscard]] bool connected() const override { return true; }
  /// Port name for programs: "step:" and the path.
  [[nodiscard]] std::string name() const override;

 private:
  struct Program {
    int descriptor = -1;
    bool asked = false;  ///< its request is not answered yet
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
