#include "tactree/client/connection.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "tactree/client/link_error.hpp"
#include "thread_priority.hpp"

namespace tactree::client {
namespace {

using core::wire::MessageKind;
using core::wire::WireStatus;
using std::chrono::microseconds;

// Maximum delay of a posted request, and of a heartbeat.
constexpr microseconds kWait{500};

}  // namespace

class Connection::Worker {
 public:
  Worker(std::unique_ptr<Transport> transport, const ConnectionOptions& options)
      : transport_(std::move(transport)), options_(options), client_(options.client) {
    client_.on_telemetry([this](const Telemetry& telemetry) { keep(telemetry); });
    thread_ = std::thread([this] { run(); });
  }
  ~Worker() {
    ending_ = true;
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  Response open(std::uint16_t link_timeout_ms) {
    // The heartbeats of a required link must not wait for other programs of this computer. Time in
    // lock-step does not pass meanwhile.
    wants_priority_ = link_timeout_ms != 0U && !transport_->in_lock_step();
    std::unique_lock lock(mutex_);
    return await(lock, client_.open(link_timeout_ms, std::random_device{}(), now_us()));
  }

  Response call(MessageKind kind, std::span<const std::byte> payload) {
    std::unique_lock lock(mutex_);
    return await(lock, client_.send(kind, payload, now_us()));
  }

  Response call_all(std::span<const Request> requests, std::size_t window) {
    std::unique_lock lock(mutex_);
    std::deque<std::uint16_t> under_way;
    Response last;
    std::size_t next = 0;
    bool good = true;
    while ((good && next < requests.size()) || !under_way.empty()) {
      while (good && next < requests.size() && under_way.size() < window) {
        under_way.push_back(client_.send(requests[next].kind, requests[next].payload, now_us()));
        ++next;
      }
      Response response = await(lock, under_way.front());
      under_way.pop_front();
      if (good) {
        good = response.ok();
        last = std::move(response);
      }
    }
    return last;
  }

  void post(MessageKind kind, std::span<const std::byte> payload) {
    const std::lock_guard lock(mutex_);
    posted_.insert(client_.send(kind, payload, now_us()));
  }

  [[nodiscard]] std::uint64_t refusals() const {
    const std::lock_guard lock(mutex_);
    return refusals_;
  }
  [[nodiscard]] std::optional<Telemetry> latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }
  [[nodiscard]] std::vector<Telemetry> take_stream() {
    const std::lock_guard lock(mutex_);
    return std::exchange(stream_, {});
  }
  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_ + (latest_ ? latest_->header.dropped : 0U);
  }
  [[nodiscard]] bool connected() const {
    const std::lock_guard lock(mutex_);
    return transport_->connected();
  }
  [[nodiscard]] bool in_session() const {
    const std::lock_guard lock(mutex_);
    return transport_->connected() && client_.state() == Client::State::kOpen;
  }
  [[nodiscard]] std::string name() const { return transport_->name(); }
  [[nodiscard]] microseconds now() const { return transport_->now(); }

  void sleep(microseconds duration) {
    if (!transport_->in_lock_step()) {
      std::this_thread::sleep_for(duration);
      return;
    }
    std::unique_lock lock(mutex_);
    const microseconds end = now() + duration;
    const Waiting waiting(waiting_);
    arrived_.wait(lock, [&] { return now() >= end; });
  }

  /// The thread of run() looks at least every kWait, also after a loss of the board.
  void wait_for_stream(microseconds duration) {
    std::unique_lock lock(mutex_);
    const microseconds end = now() + duration;
    arrived_.wait(lock, [&] { return !stream_.empty() || now() >= end; });
  }

 private:
  /// Counts the threads that wait for the board or its time.
  class Waiting {
   public:
    explicit Waiting(std::atomic<int>& count) : count_(count) { ++count_; }
    ~Waiting() { --count_; }
    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;

   private:
    std::atomic<int>& count_;
  };

  [[nodiscard]] Microseconds now_us() const { return static_cast<Microseconds>(now().count()); }

  void run() {
    while (!ending_) {
      if (wants_priority_.exchange(false)) {
        (void)prefer_this_thread();
      }
      {
        const std::lock_guard lock(mutex_);
        exchange();
      }
      arrived_.notify_all();
      if (transport_->connected()) {
        transport_->wait(kWait);
      }
      // Without a wait above, the loop would not sleep. Simulated time passes as fast as possible
      // while a thread waits for it, otherwise not faster than real time.
      if (!transport_->connected() || (transport_->in_lock_step() && waiting_ == 0)) {
        std::this_thread::sleep_for(kWait);
      }
    }
    const std::lock_guard lock(mutex_);
    exchange();  // the last requests
  }

  void exchange() {
    std::array<std::byte, 4096> bytes{};
    const Microseconds time_us = now_us();
    std::size_t count = 0;
    while ((count = transport_->read(bytes)) > 0U) {
      client_.receive(std::span(bytes).first(count), time_us);
    }
    client_.advance(time_us);
    client_.sent(transport_->write(client_.to_send()));
    Response response;
    while (client_.take(response)) {
      keep(std::move(response));
    }
  }

  void keep(Response response) {
    if (posted_.erase(response.sequence) != 0U) {
      refusals_ += response.ok() ? 0U : 1U;
    } else {
      responses_.push_back(std::move(response));
    }
  }

  void keep(const Telemetry& telemetry) {
    latest_ = telemetry;
    if (stream_.size() < options_.stream_capacity) {
      stream_.push_back(telemetry);
    } else {
      ++dropped_;
    }
  }

  /// The client provides a response for each request, at the latest at its timeout.
  Response await(std::unique_lock<std::mutex>& lock, std::uint16_t sequence) {
    const auto is_it = [sequence](const Response& r) { return r.sequence == sequence; };
    auto found = responses_.end();
    const Waiting waiting(waiting_);
    arrived_.wait(lock, [&] {
      found = std::find_if(responses_.begin(), responses_.end(), is_it);
      return found != responses_.end();
    });
    Response response = std::move(*found);
    responses_.erase(found);
    return response;
  }

  std::unique_ptr<Transport> transport_;
  ConnectionOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  Client client_;
  std::deque<Response> responses_;
  std::set<std::uint16_t> posted_;
  std::optional<Telemetry> latest_;
  std::vector<Telemetry> stream_;
  std::uint64_t dropped_ = 0;
  std::uint64_t refusals_ = 0;
  std::atomic<bool> ending_ = false;
  std::atomic<bool> wants_priority_ = false;
  std::atomic<int> waiting_ = 0;
  std::thread thread_;
};

Connection::Connection(std::unique_ptr<Transport> transport, const ConnectionOptions& options)
    : worker_(std::make_unique<Worker>(std::move(transport), options)) {}

Connection::~Connection() = default;

void Connection::open(std::uint16_t link_timeout_ms) {
  const Response response = worker_->open(link_timeout_ms);
  if (response.timed_out) {
    throw LinkError(name() + ": no answer (is it a board with Tactree's firmware, at this speed?)");
  }
  if (response.status == WireStatus::kBusy) {
    throw LinkError(name() + ": " + core::wire::describe(response.status) +
                    " (tactree stop, or end the program that armed it)");
  }
  if (!response.ok()) {
    throw LinkError(name() + ": " + core::wire::describe(response.status));
  }
  core::wire::OpenReply reply;
  protocol_minor_ = response.read(reply) ? reply.version_minor : std::uint8_t{0};
}

Response Connection::call(MessageKind kind, std::span<const std::byte> payload) {
  return worker_->call(kind, payload);
}
Response Connection::call_all(std::span<const Request> requests, std::size_t window) {
  return worker_->call_all(requests, window);
}
void Connection::post(MessageKind kind, std::span<const std::byte> payload) {
  worker_->post(kind, payload);
}
std::uint64_t Connection::refusals() const { return worker_->refusals(); }
std::optional<Telemetry> Connection::latest() const { return worker_->latest(); }
std::vector<Telemetry> Connection::take_stream() { return worker_->take_stream(); }
std::uint64_t Connection::dropped() const { return worker_->dropped(); }
std::chrono::microseconds Connection::now() const { return worker_->now(); }
void Connection::sleep(std::chrono::microseconds duration) const { worker_->sleep(duration); }
void Connection::wait_for_stream(std::chrono::microseconds duration) const {
  worker_->wait_for_stream(duration);
}
bool Connection::connected() const { return worker_->connected(); }
bool Connection::in_session() const { return worker_->in_session(); }
std::string Connection::name() const { return worker_->name(); }

}  // namespace tactree::client
