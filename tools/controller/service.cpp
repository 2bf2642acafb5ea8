#include "service.hpp"

#include <fmt/core.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>

#include "exit_codes.hpp"
#include "real_time.hpp"
#include "tactree/core/safety/faults.hpp"
#include "tactree/hal/linux/gadget_port.hpp"
#include "tactree/hal/linux/local_socket_port.hpp"
#include "tactree/hal/loop.hpp"
#include "tactree/session/session.hpp"
#include "tactree/store/no_model_store.hpp"
#include "tactree/support/blob_file.hpp"
#include "tactree/support/user_error.hpp"

namespace tactree::controller {
namespace {

using hal::linux_gpio::ControllerBoard;

// Maximum number of session steps before a tick, and the reciprocal of the fraction of the period
// that they must leave for the kernel to start the tick.
constexpr int kPiecesPerTick = 64;
constexpr std::uint64_t kReserve = 4;

/// Ticks and session run in the same thread, therefore hold_ticks() has no effect.
class Platform {
 public:
  explicit Platform(ControllerBoard& board) : board_(board) {}
  [[nodiscard]] std::uint32_t now_us() noexcept { return board_.ticker().now_us(); }
  void hold_ticks(bool) noexcept {}

 private:
  ControllerBoard& board_;
};

std::string lateness_table(const hal::linux_time::LatenessHistogram& lateness) {
  std::string text =
      fmt::format("lateness of a tick: min {:.1f} us, mean {:.1f} us, max {:.1f} us\n",
                  1e-3 * static_cast<double>(lateness.min_ns()), 1e-3 * lateness.mean_ns(),
                  1e-3 * static_cast<double>(lateness.max_ns()));
  constexpr std::uint32_t kLast = hal::linux_time::LatenessHistogram::kBuckets - 1U;
  for (std::uint32_t i = 0; i <= kLast; ++i) {
    if (lateness.in_bucket(i) != 0U) {
      const std::string range = i < kLast ? fmt::format("below {:>8} us", lateness.end_us(i))
                                          : fmt::format("above {:>8} us", lateness.end_us(i - 1U));
      text += fmt::format("  {} {:>12}\n", range, lateness.in_bucket(i));
    }
  }
  return text;
}

/// State of the loop, for other threads.
struct Progress {
  std::atomic<bool> ending{false};
  std::atomic<std::uint64_t> minor_faults{0};
  std::atomic<std::uint64_t> major_faults{0};
  std::atomic<std::uint64_t> allocations{0};
  std::atomic<std::uint32_t> faults{0};
  std::atomic<std::uint32_t> state{0};
};

void print_report(const ControllerBoard& board, const Progress& progress) {
  const auto& lateness = board.clock().lateness();
  std::string text = fmt::format(
      "ticks: {} at {:.6g} Hz; deadlines missed: {}\n"
      "page faults after the start: {} minor, {} major; allocations after the start: {}\n"
      "encoder edges lost: {}\n"
      "state: {}; faults latched: {:#x}\n",
      lateness.count(), 1e9 / static_cast<double>(board.clock().period_ns()),
      board.clock().missed(), progress.minor_faults.load(), progress.major_faults.load(),
      progress.allocations.load(), board.edges_lost(),
      core::name_of(static_cast<core::State>(progress.state.load())), progress.faults.load());
  text += lateness_table(lateness);
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

/// Thread that handles signals and prints the reports that they request, so that the loop does not.
class Attendant {
 public:
  Attendant(const ControllerBoard& board, Progress& progress)
      : board_(board), progress_(progress), thread_([this] { attend(); }) {}
  ~Attendant() {
    progress_.ending = true;
    // NOLINTNEXTLINE(bugprone-bad-signal-to-kill-thread): the thread waits for it in sigwait().
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  Attendant(const Attendant&) = delete;
  Attendant& operator=(const Attendant&) = delete;

  /// Call it before any thread is created, so that only this thread receives the signals.
  static void block_signals() {
    const sigset_t wanted = signals();
    (void)pthread_sigmask(SIG_BLOCK, &wanted, nullptr);
  }

 private:
  static sigset_t signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) {
      sigaddset(&set, signal);
    }
    return set;
  }

  void attend() {
    const sigset_t wanted = signals();
    int signal = 0;
    while (!progress_.ending) {
      if (sigwait(&wanted, &signal) != 0) {
        continue;
      }
      if (signal == SIGUSR1) {
        print_report(board_, progress_);
      } else {
        progress_.ending = true;
      }
    }
  }

  const ControllerBoard& board_;
  Progress& progress_;
  std::thread thread_;
};

void check_start(const ControllerFile& file, const hal::StartResult& start) {
  // Configuration and blob were checked when they were read.
  if (start.model != core::ModelStatus::kOk) {
    throw support::UserError(fmt::format("{}: {} (build it for this rate and device)",
                                         file.model.string(), describe(start)));
  }
  if (!start.ok()) {
    throw support::UserError(
        fmt::format("{}: refused: {} (see --dry-run)", file.file, describe(start)));
  }
}

void tell_missing(const ControllerFile& file, const std::vector<std::string>& missing) {
  for (const std::string& sentence : missing) {
    if (file.real_time.required) {
      throw support::UserError(fmt::format("{}: real_time.required: {}", file.file, sentence));
    }
    fmt::print(stderr, "tactree-controller: warning: not in real time: {}\n", sentence);
  }
}

void attend(hal::LocalSocketPort& port, const core::Status&, std::uint32_t) { port.accept(); }
void attend(hal::GadgetPort& port, const core::Status& status, std::uint32_t now_us) {
  port.attend(status, now_us);
}

/// Runs the ticks, and the session between them. The constructor creates everything that they need.
template <hal::BytePort Port>
class Runner {
 public:
  using Session = session::Session<Port, store::NoModelStore, Platform>;

  template <class... PortArguments>
  Runner(const ControllerFile& file, const support::BlobFile& model, const PortArguments&... port)
      : file_(file),
        board_(file.board, model.bytes(), mailbox_),
        port_(port...),
        platform_(board_),
        identity_{"linux", TACTREE_VERSION, {0, 0, file.link.usb_serial}, 0},
        loop_(board_, controller_),
        session_({port_, store_, platform_, controller_, mailbox_, identity_}) {
    const hal::StartResult start = loop_.start(file.configuration);
    check_start(file, start);
    session_.started(start, file.configuration);
  }

  /// `where` is the address for applications, for a message.
  void run(const std::string& where) {
    const Attendant attendant(board_, progress_);
    tell_missing(file_, enter_real_time(file_.real_time));
    fmt::print("tactree-controller: serving {} at {}\n", file_.device.name, where);
    if (const std::string used = support::defaults_text(file_.device); !used.empty()) {
      fmt::print("tactree-controller: defaults of the device: {}\n", used);
    }
    std::fflush(stdout);
    const Disturbances before = disturbances();
    while (!progress_.ending.load(std::memory_order_relaxed)) {
      const core::Output& output = loop_.tick();
      progress_.state.store(static_cast<std::uint32_t>(output.status.state),
                            std::memory_order_relaxed);
      progress_.faults.store(output.status.faults, std::memory_order_relaxed);
      serve_application(output.status);
      note(before);
    }
    board_.stop();
  }

  void report() const { print_report(board_, progress_); }

 private:
  void serve_application(const core::Status& status) {
    attend(port_, status, platform_.now_us());
    const std::uint64_t reserve_ns = board_.clock().period_ns() / kReserve;
    for (int i = 0; i < kPiecesPerTick && session_.work(); ++i) {
      if (board_.clock().left_ns() < reserve_ns) {
        return;
      }
    }
  }

  void note(const Disturbances& before) {
    const Disturbances now = disturbances();
    progress_.minor_faults.store(now.minor_faults - before.minor_faults, std::memory_order_relaxed);
    progress_.major_faults.store(now.major_faults - before.major_faults, std::memory_order_relaxed);
    progress_.allocations.store(now.allocations - before.allocations, std::memory_order_relaxed);
  }

  const ControllerFile& file_;
  session::TickMailbox mailbox_;
  core::Controller controller_;
  ControllerBoard board_;
  Port port_;
  Platform platform_;
  store::NoModelStore store_;
  session::BoardIdentity identity_;
  hal::Loop<ControllerBoard> loop_;
  Session session_;
  Progress progress_;
};

template <hal::BytePort Port, class... PortArguments>
int serve_over(const ControllerFile& file, const std::string& where, const PortArguments&... port) {
  const support::BlobFile model(file.model);
  Attendant::block_signals();
  Runner<Port> runner(file, model, port...);
  runner.run(where);
  runner.report();
  return kExitOk;
}

}  // namespace

int serve(const ControllerFile& file) {
  const LinkSettings& link = file.link;
  if (!link.socket.empty()) {
    return serve_over<hal::LocalSocketPort>(file, link.socket, link.socket);
  }
  core::usb::Identity identity;
  identity.serial = {0, 0, link.usb_serial};
  const std::string port = hal::linux_usb::find_udc(link.usb_port);
  return serve_over<hal::GadgetPort>(file, "USB device port " + port, identity, port);
}

}  // namespace tactree::controller
