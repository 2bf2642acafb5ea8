// The thread of a connection, which sends the heartbeats.

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <chrono>
#include <latch>
#include <memory>
#include <thread>

#include "running_board.hpp"
#include "tactree/client/board.hpp"
#include "tactree/client/link_error.hpp"
#include "thread_priority.hpp"

namespace tactree::test {
namespace {

using std::chrono::microseconds;

TEST(Heartbeat, ContinuesWhileProgramIsBlocked) {
  constexpr int kTicks = 200;  // of 1 ms
  std::latch passed(kTicks);
  std::atomic<int> left = 0;
  std::atomic<int> inactive = 0;
  const RunningBoard running(0.04, true, [&](const simulation::Sample& sample) {
    if (left.load() > 0) {
      inactive += sample.status.state == core::State::kActive ? 0 : 1;
      --left;
      passed.count_down();
    }
  });
  client::Board board(running.port(), {.link_timeout_ms = 5});
  board.arm();
  left = kTicks;
  passed.wait();
  EXPECT_EQ(inactive.load(), 0);
}

int policy_of_this_thread() {
  int policy = -1;
  sched_param parameters{};
  return pthread_getschedparam(pthread_self(), &policy, &parameters) == 0 ? policy : -1;
}

/// A port of which nothing answers. Time passes within wait() only.
class SilentPort : public client::Transport {
 public:
  explicit SilentPort(std::atomic<int>& policy) : policy_(policy) {}

  std::size_t read(std::span<std::byte>) override { return 0; }
  std::size_t write(std::span<const std::byte> bytes) override { return bytes.size(); }
  void wait(microseconds timeout) override {
    policy_ = policy_of_this_thread();
    now_us_ += timeout.count();
    std::this_thread::sleep_for(microseconds(10));
  }
  [[nodiscard]] microseconds now() const override { return microseconds(now_us_.load()); }
  [[nodiscard]] bool connected() const override { return true; }
  [[nodiscard]] std::string name() const override { return "silent port"; }

 private:
  std::atomic<int>& policy_;
  std::atomic<std::int64_t> now_us_ = 0;
};

/// Scheduling of the thread that would send the heartbeats of a link with this timeout.
int policy_of_link(std::uint16_t link_timeout_ms) {
  std::atomic<int> policy = -1;
  client::Connection connection(std::make_unique<SilentPort>(policy));
  EXPECT_THROW(connection.open(link_timeout_ms), client::LinkError);
  return policy;
}

TEST(Heartbeat, PrecedesOtherProgramsIfAllowedAndRequired) {
  bool is_allowed = false;  // to this user
  std::thread([&] { is_allowed = client::prefer_this_thread(); }).join();
  const int usual = policy_of_this_thread();
  EXPECT_EQ(policy_of_link(35), is_allowed ? SCHED_RR : usual);
  EXPECT_EQ(policy_of_link(0), usual);
}

}  // namespace
}  // namespace tactree::test
