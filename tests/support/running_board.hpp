#pragma once
// A served board that runs in a thread, in lock-step with the program that is connected.

#include <atomic>
#include <chrono>
#include <functional>
#include <latch>
#include <string>
#include <thread>
#include <utility>

#include "tactree/client/connection.hpp"
#include "tactree/client/lock_step.hpp"
#include "tactree/serve/served_target.hpp"
#include "tactree/simulation/simulation.hpp"
#include "test_models.hpp"

namespace tactree::test {

/// Its model is a sphere of 3 cm radius; the simulated hand moves to `height_m` above the centre.
class RunningBoard {
 public:
  /// Called from the thread of the board after each tick.
  using Observer = std::function<void(const simulation::Sample&)>;

  /// Returns when the port is open. `may_command`: see core::LinkSupervision.
  explicit RunningBoard(double height_m = 0.04, bool may_command = true, Observer observer = {})
      : observer_(std::move(observer)),
        thread_([this, height_m, may_command] { run(height_m, may_command); }) {
    listening_.wait();
  }
  ~RunningBoard() {
    ending_ = true;
    thread_.join();
  }
  RunningBoard(const RunningBoard&) = delete;
  RunningBoard& operator=(const RunningBoard&) = delete;

  [[nodiscard]] std::string port() const { return server_.name(); }
  /// Of its socket: another name of it, after "step:", is a port as well.
  [[nodiscard]] std::string path() const { return port().substr(port().find(':') + 1); }
  /// Simulates a board that hangs: the port stays open, nothing is answered, and time passes.
  void freeze(bool frozen) { frozen_ = frozen; }
  void press_emergency_stop(bool pressed) { emergency_stop_ = pressed; }
  /// The model until another one is written.
  [[nodiscard]] static const TestBlob& model() {
    static const TestBlob kModel(sphere(0.03, 0.002));
    return kModel;
  }

 private:
  void run(double height_m, bool may_command) {
    const std::span<const std::byte> blob = model().written().bytes;
    simulation::Setup setup;
    setup.controller.supervision.dead_man_required = false;
    setup.controller.link.may_command = may_command;
    simulation::HandPath path({{0.0, {0.0, 0.0, 0.04}}, {1.0, {0.0, 0.0, height_m}}});
    simulation::Simulation simulation(
        blob, setup, path,
        std::make_unique<serve::ServedTarget>(server_, blob, serve::ServeOptions{}));
    listening_.count_down();
    double hand_s = 0.0;
    while (!ending_) {
      if (!frozen_) {
        simulation.board().safety_inputs().press_emergency_stop(emergency_stop_);
        hand_s = simulation.state() == core::State::kActive ? hand_s + 0.001 : 0.0;
        const simulation::Sample sample = simulation.step_with_hand_at(hand_s);
        if (observer_) {
          observer_(sample);
        }
      }
      server_.pass(std::chrono::milliseconds(1), [this] { return ending_.load(); });
    }
  }

  Observer observer_;
  client::LockStepServer server_;
  std::latch listening_{1};
  std::atomic<bool> ending_ = false;
  std::atomic<bool> emergency_stop_ = false;
  std::atomic<bool> frozen_ = false;
  std::thread thread_;
};

/// Looks every 10 ms, for up to 30 s of the board's time.
template <class Condition>
bool comes_true(const client::Connection& connection, Condition condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) {
      return true;
    }
    connection.sleep(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace tactree::test
