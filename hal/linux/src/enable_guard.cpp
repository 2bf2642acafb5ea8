// Loop and memory annotations: docs/BOUND.md.

#include "tactree/hal/linux/enable_guard.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <new>
#include <string>

namespace tactree::hal::linux_gpio {
namespace {

constexpr int kParentIsGone = SIGUSR2;

// Checks per `silence_ns`. Detection takes at most one more check, hence 1.25 times `silence_ns`,
// plus the delay that the kernel adds to five sleeps. More checks would wake the guard more often.
constexpr std::uint64_t kLooks = 4;

void ignore(int) {}

// A terminal or a service manager sends signals to the whole group; the guard must outlive the
// loop.
void outlive_the_others() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGUSR1, SIGPIPE}) {  // bound: 6
    (void)std::signal(signal, SIG_IGN);
  }
  struct sigaction wake {};
  wake.sa_handler = ignore;  // without SA_RESTART, so a signal ends a sleep
  (void)sigaction(kParentIsGone, &wake, nullptr);
  sigset_t none;
  sigemptyset(&none);
  (void)sigprocmask(SIG_SETMASK, &none, nullptr);
}

void be_quick(int priority) {
  (void)mlockall(MCL_CURRENT);
  if (priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = priority;
    (void)sched_setscheduler(0, SCHED_FIFO, &parameters);
  }
}

void print(const char* text) { (void)!::write(STDERR_FILENO, text, std::strlen(text)); }

}  // namespace

struct EnableGuard::Shared {
  std::atomic<std::uint32_t> beats{0};
  std::atomic<bool> resting{false};
  std::atomic<bool> done{false};
};

namespace {

/// Returns true if the loop is silent, false if it has ended. Checks at least four times per
/// `silence_ns`.
template <class Shared>
bool watch(const Shared& shared, pid_t parent, std::uint64_t silence_ns) {
  const std::uint64_t look_ns = silence_ns / kLooks;
  const timespec look{static_cast<time_t>(look_ns / 1'000'000'000U),
                      static_cast<decltype(timespec::tv_nsec)>(look_ns % 1'000'000'000U)};
  std::uint32_t last = 0;
  std::uint64_t quiet = 0;
  while (getppid() == parent && !shared.done.load()) {  // bound: for_ever
    const std::uint32_t beats = shared.beats.load();
    const bool expected = beats != 0U && !shared.resting.load();
    quiet = expected && beats == last ? quiet + 1U : 0U;
    last = beats;
    if (quiet >= kLooks) {
      return true;
    }
    (void)nanosleep(&look, nullptr);
  }
  return false;
}

}  // namespace

EnableGuard::EnableGuard(GpioLines& enable, const GuardSettings& settings) {
  void* const memory =
      mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    throw std::runtime_error(std::string("guard of the enable line: ") + std::strerror(errno));
  }
  shared_ = new (memory) Shared;
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) {
    throw std::runtime_error(std::string("guard of the enable line: cannot fork: ") +
                             std::strerror(errno));
  }
  if (process_ > 0) {
    return;
  }
  outlive_the_others();
  (void)prctl(PR_SET_PDEATHSIG, kParentIsGone);
  (void)prctl(PR_SET_NAME, "tactree-guard");
  be_quick(settings.priority);
  const bool silent = watch(*shared_, parent, settings.silence_ns);
  const bool off = enable.set(0);
  if (silent) {
    (void)kill(parent, SIGKILL);
    (void)enable.set(0);  // again: the loop may have switched it on before it was killed
    print("tactree guard: the control loop did not respond; enable line off, loop killed\n");
  } else if (!shared_->done.load()) {
    print("tactree guard: the control loop has ended; enable line off\n");
  }
  _exit(off ? 0 : 1);
}

EnableGuard::~EnableGuard() {
  shared_->done.store(true);
  (void)kill(process_, kParentIsGone);
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {  // bound: signals
  }
  (void)munmap(shared_, sizeof(Shared));
}

void EnableGuard::beat() noexcept {
  // The value 0 is reserved: no beat yet.
  const std::uint32_t next = shared_->beats.load(std::memory_order_relaxed) + 1U;
  shared_->beats.store(next == 0U ? 1U : next);
}

void EnableGuard::rest() noexcept { shared_->resting.store(true); }

}  // namespace tactree::hal::linux_gpio
